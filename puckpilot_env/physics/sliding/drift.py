"""A puck that meets nothing for a while, whatever the mallets do meanwhile: no need to look at what they do."""

from __future__ import annotations

from puckpilot_env.kernel import inlined_kernel, kernel
from puckpilot_env.physics import compose
from puckpilot_env.physics.contacts import bounce
from puckpilot_env.physics.contacts.contact import stays_clear
from puckpilot_env.physics.contacts.curved_contact import first_boundary, stays_clear_of_curve
from puckpilot_env.physics.exposures import of_glide, of_leg
from puckpilot_env.physics.gantry.mallet import place_now, reach_under
from puckpilot_env.physics.sliding import curve, glide, slide
from puckpilot_env.physics.sliding.leg import leg
from puckpilot_env.physics.vector import size

SLOW = 1e-2  # m/s; a slower puck that forces drive may lean on something, which is not asked here


@kernel
def _reach(mallet, p, orders, duration):
    """`(x, y)`: bounds [m] on how far a mallet gets in `duration` [s] if it takes up `orders` meanwhile. A motor that
    rubs adds along one axis what it loses along the other."""
    rubs = compose.dry_friction(p)
    more = rubs[0] + rubs[1]
    x = reach_under(mallet.x, max(abs(mallet.x.volts), abs(orders[0, 0])) + more, duration)
    return x, reach_under(mallet.y, max(abs(mallet.y.volts), abs(orders[1, 0])) + more, duration)


@kernel
def _stays_clear(puck, p, mallets, orders, ux, uy, travel, end):
    """Whether a puck that moves `travel` [m] along the unit vector `u` is out of the mallets' reach until `end` [s]."""
    distance = p.puck_radius + p.mallet_radius
    for k in range(2):
        home_x, home_y = place_now(mallets[k])
        reach_x, reach_y = _reach(mallets[k], p, orders[k], end)
        if not stays_clear(puck.x, puck.y, ux, uy, travel, home_x, home_y, reach_x, reach_y, distance):
            return False
    return True


@kernel
def _glide(puck, p, mallets, orders, end, film):
    v = size(puck.vx, puck.vy)
    ux, uy = (puck.vx / v, puck.vy / v) if v > 0.0 else (1.0, 0.0)
    travel = glide.distance(v, end, p.friction, p.drag)
    if v > 0.0:
        _, kind = bounce.first_boundary(puck.x, puck.y, ux, uy, travel, p.length, p.width, p.goal_width, p.puck_radius)
        if kind != bounce.NOTHING or bounce.distance_to_middle(puck.x, ux, p.length) < travel:
            return 0.0
    if not _stays_clear(puck, p, mallets, orders, ux, uy, travel, end):
        return 0.0
    if film.shape[0] > 0:
        of_glide(film, puck, ux, uy, v, 0.0, end, p.friction, p.drag)
    slide.move(puck, p, ux, uy, v, end, p.friction, p.drag)
    return end


@kernel
def _may_meet(puck, p, mallets, orders, end):
    """Whether a puck that forces drive would meet something if they did nothing: no need to find its way then."""
    v = size(puck.vx, puck.vy)
    x, y, travel = puck.x + puck.vx * end, puck.y + puck.vy * end, v * end
    if min(x, p.length - x) < p.puck_radius or min(y, p.width - y) < p.puck_radius:
        return True
    if (puck.x < 0.5 * p.length) != (x < 0.5 * p.length):
        return True
    ux, uy = (puck.vx / v, puck.vy / v) if v > 0.0 else (1.0, 0.0)
    return not _stays_clear(puck, p, mallets, orders, ux, uy, travel, end)


@inlined_kernel
def _ride(puck, p, mallets, orders, clock, least, end, film):
    leans = 0.0 < puck.vx * puck.vx + puck.vy * puck.vy < SLOW * SLOW
    if leans or _may_meet(puck, p, mallets, orders, end):
        return 0.0
    h, ax, ay, x, y, vx, vy, bx, by = leg(puck, p, clock, end, 1.0, 1.0)
    if h < least:
        return 0.0
    cx = curve.through(puck.x, puck.vx, ax, x, vx, bx, h)
    cy = curve.through(puck.y, puck.vy, ay, y, vy, by, h)
    bend_x, bend_y = curve.most_bend(cx), curve.most_bend(cy)
    if first_boundary(cx, cy, x, y, bend_x, bend_y, p, 0.0, 0.0)[1] != bounce.NOTHING:
        return 0.0
    room = p.puck_radius + p.mallet_radius + 0.125 * (bend_x + bend_y)
    for k in range(2):
        home_x, home_y = place_now(mallets[k])
        reach_x, reach_y = _reach(mallets[k], p, orders[k], h)
        if not stays_clear_of_curve(cx[0], cy[0], x - cx[0], y - cy[0], room, home_x, home_y, reach_x, reach_y):
            return 0.0
    if film.shape[0] > 0:
        of_leg(film, cx, cy, 0.0, h, h)
    puck.x, puck.y, puck.vx, puck.vy = x, y, vx, vy
    slide.fade_spin(puck, p, h)
    return h


@kernel
def drift(puck, p, mallets, orders, clock, least, end, film):
    """Move the puck on from where the plans begin, for `least` to `end` [s], if it meets nothing whenever the mallets
    take up `orders`; how long it was moved, or 0 if it was not. `clock` and `film` as in `advance.advance`."""
    if compose.is_forced(p):
        return _ride(puck, p, mallets, orders, clock, least, end, film)
    return _glide(puck, p, mallets, orders, end, film)
