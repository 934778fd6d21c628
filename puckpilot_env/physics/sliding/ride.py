"""One leg of the puck's way on a table with forces, up to what it meets first."""

from __future__ import annotations

from puckpilot_env.kernel import kernel
from puckpilot_env.physics.contacts import bounce
from puckpilot_env.physics.contacts.curved_contact import first_boundary, first_strike
from puckpilot_env.physics.exposures import of_leg
from puckpilot_env.physics.sliding import curve
from puckpilot_env.physics.sliding.leg import leg
from puckpilot_env.physics.sliding.slide import fade_spin
from puckpilot_env.physics.sliding.support import is_held, lean
from puckpilot_env.physics.vector import size

SLOW = 1e-2  # m/s; a faster puck is not asked whether something holds it
SINKING = 5e-4  # s; a puck that forces press on a post may sink in for so long, by at most SUNK, between two bounces


@kernel
def _slowest_at_post(puck, p, ax, ay):
    """How fast [m/s] a puck has to close in on the nearest post for a contact: one that accelerates towards it by `a`
    comes to that within SINKING."""
    if min(puck.x, p.length - puck.x) > 2.0 * p.puck_radius:
        return bounce.SLIDING
    post_x, post_y = bounce.nearest_post(puck.x, puck.y, p.length, p.width, p.goal_width)
    dx, dy = puck.x - post_x, puck.y - post_y
    return max(-SINKING * (ax * dx + ay * dy) / size(dx, dy), bounce.SLIDING)


@kernel
def _lift_off_post(puck, p):
    """Take a puck out of the post that it has sunk into."""
    post_x, post_y = bounce.nearest_post(puck.x, puck.y, p.length, p.width, p.goal_width)
    dx, dy = puck.x - post_x, puck.y - post_y
    apart = size(dx, dy)
    if apart < p.puck_radius:
        puck.x, puck.y = post_x + dx * p.puck_radius / apart, post_y + dy * p.puck_radius / apart


@kernel
def ride(puck, p, mallets, clock, t, end, film):
    """Move the puck from `t` on to what it meets first, at most to `end` [s] of the plans: `(kind, time)`.

    `clock` [s] is the time of the episode when the plans began; `film` as in `advance`.
    """
    free_x, free_y = lean(puck, p, clock + t)
    if puck.vx * puck.vx + puck.vy * puck.vy < SLOW * SLOW and is_held(puck, p, mallets, clock, t):
        puck.vx, puck.vy, free_x, free_y = 0.0, 0.0, 0.0, 0.0
    h, ax, ay, x, y, vx, vy, bx, by = leg(puck, p, clock + t, end - t, free_x, free_y)
    cx = curve.through(puck.x, puck.vx, ax, x, vx, bx, h)
    cy = curve.through(puck.y, puck.vy, ay, y, vy, by, h)
    bend_x, bend_y = curve.most_bend(cx), curve.most_bend(cy)
    slowest, slowest_at_post = bounce.SLIDING * h, _slowest_at_post(puck, p, ax, ay) * h
    share, kind = first_boundary(cx, cy, x, y, bend_x, bend_y, p, slowest, slowest_at_post)
    until = end if h == end - t else t + h
    if kind != bounce.NOTHING:
        until = min(t + share * h, until)
        x, y = curve.place(cx, share), curve.place(cy, share)
        vx, vy = curve.rate(cx, share) / h, curve.rate(cy, share) / h
    met, player = first_strike(cx, cy, x, y, bend_x, bend_y, p, mallets, t, h, until)
    if met < until:
        kind, until = bounce.MALLET_0 + player, met
        share = (met - t) / h
        x, y = curve.place(cx, share), curve.place(cy, share)
        vx, vy = curve.rate(cx, share) / h, curve.rate(cy, share) / h
    if film.shape[0] > 0:
        of_leg(film, cx, cy, t, h, until)
    puck.x, puck.y, puck.vx, puck.vy = x, y, vx, vy
    if kind == bounce.POST:
        _lift_off_post(puck, p)
    fade_spin(puck, p, until - t)
    return kind, until
