"""Puck against mallet: the earliest contact, the impulse, and what happens to a pinched puck.

The distance between puck and mallet, `g`, has `g'' >= -A` where `A` bounds the size of their relative acceleration
(the rest of `g''` is the square of the sideways speed over `g`, which is never negative). So `g(t) >= g0 + g0' t -
A t^2/2`, and advancing to the smallest root of that parabola again and again can never jump over a contact; near the
contact it converges quadratically. This is sharper than the bound by speeds in report appendix H (errata row H.5).
The root is that at a gap of `-TOUCH`: a puck that slides along a mallet advances by `sqrt(2 TOUCH/A)` at the least.
"""

from __future__ import annotations

import math

from puckpilot_env.kernel import kernel
from puckpilot_env.physics.gantry.mallet import acceleration_bound, axis_at, axis_velocity, next_switch
from puckpilot_env.physics.sliding import glide
from puckpilot_env.physics.vector import size

TOUCH = 1e-11  # m; a gap below it is a contact
SLOWEST = 1e-9  # m/s; two that touch and close in more slowly, by rounding, are no contact: it would have no end
SHORTEST_ADVANCE = 1e-12  # s; less than the rounding of a time may be no advance at all
MOST_ADVANCES = 2000  # of one search; a puck that grazes a mallet for longer touches it
REST_BETWEEN_TOUCHES = 1e-3  # s; a mallet that pushes the puck along touches it about this often
PINCH_SLACK = 5e-5  # m; a puck this near to a wall while a mallet strikes it is between the two
LEAST_REBOUND = 1e-6  # m/s; a puck squeezed against a wall leaves it, so that rounding makes no bounce of it
SQUEEZED_SPEED = 300.0  # m/s; only a puck squeezed by two that close in on each other, all elastic, gets so fast
STEEPEST_WEDGE = 0.0625  # sin^2 of the angle (14.5 degrees) under which a pinched puck cannot slip out


@kernel
def stays_clear(x, y, ux, uy, travel, mallet_x, mallet_y, reach_x, reach_y, distance):
    """True where a puck moving `travel` [m] along `u` cannot meet a mallet that stays within `reach` of its place."""
    dx, dy = mallet_x - x, mallet_y - y
    along = min(max(dx * ux + dy * uy, 0.0), travel)
    apart = size(dx - along * ux, dy - along * uy)
    return apart > distance + size(reach_x, reach_y)


@kernel
def time_to_parabola(gap, gap_rate, bound):
    """Smallest positive root of `gap + gap_rate t - bound t^2/2`; infinite if there is none. gap, bound >= 0."""
    root = math.sqrt(gap_rate * gap_rate + 2.0 * bound * gap)
    if gap_rate < 0.0:
        return 2.0 * gap / (root - gap_rate)
    if bound <= 0.0:
        return math.inf
    return (gap_rate + root) / bound


@kernel
def first_contact(x, y, ux, uy, v, friction, drag, mallet, start, end, distance):
    """Time in [start, end) at which a freely gliding puck first meets a mallet; infinite if it does not.

    `(x, y)`, unit `u` and speed `v` [m/s] are the puck's at `start` [s]; `distance` [m] is the sum of the radii.
    """
    t = max(start, 0.0)  # before the plans begin there is no contact
    for _ in range(MOST_ADVANCES):
        path_length, speed = glide.advance(v, t - start, friction, drag)
        rest_x, slow_x, fast_x, volts_x = axis_at(mallet.x, t)
        rest_y, slow_y, fast_y, volts_y = axis_at(mallet.y, t)
        dx = x + ux * path_length - (rest_x + slow_x + fast_x)
        dy = y + uy * path_length - (rest_y + slow_y + fast_y)
        apart = math.sqrt(dx * dx + dy * dy)
        rate = (
            dx * (ux * speed - axis_velocity(mallet.x, slow_x, fast_x))
            + dy * (uy * speed - axis_velocity(mallet.y, slow_y, fast_y))
        ) / apart
        gap = apart - distance
        if gap <= TOUCH and rate < -SLOWEST:
            return t
        bound_x = acceleration_bound(mallet.x, slow_x, fast_x, volts_x)
        bound_y = acceleration_bound(mallet.y, slow_y, fast_y, volts_y)
        bound = math.sqrt(bound_x * bound_x + bound_y * bound_y)
        if speed > 0.0:
            bound += friction + drag * speed * speed
        ahead = t + max(time_to_parabola(max(gap, 0.0) + TOUCH, rate, bound), SHORTEST_ADVANCE)
        t = min(ahead, next_switch(mallet, t))
        if t >= end:
            return math.inf
    return t


@kernel
def reflect(vx, vy, mx, my, nx, ny, restitution):
    """Puck velocity after meeting a driven mallet of velocity `m`; unit normal `n` points from mallet to puck.

    The normal part of the relative velocity is reversed with `restitution`, the tangential part stays (errata, 2.3.3).
    """
    closing = (mx - vx) * nx + (my - vy) * ny
    if closing <= 0.0:
        return vx, vy
    gain = (1.0 + restitution) * closing
    return vx + gain * nx, vy + gain * ny


@kernel
def part(vx, vy, mx, my, nx, ny, push, friction, drag):
    """Puck velocity after a rebound from a mallet, away from it at least so fast that they meet again only later.

    `push` [m/s^2] is how fast they close in on each other, friction and drag of the puck apart. That replaces the
    endless sequence of ever smaller bounces of a puck being pushed along; the gap that it opens stays under
    `(push + braking) REST_BETWEEN_TOUCHES^2 / 8`, where `braking` bounds the puck's own loss of speed.
    """
    apart = (vx - mx) * nx + (vy - my) * ny
    braking = friction + drag * size(vx, vy) * max(vx * nx + vy * ny, 0.0)
    least = max(0.5 * (push + braking) * REST_BETWEEN_TOUCHES, 1e-6)
    if apart < least:
        vx, vy = vx + (least - apart) * nx, vy + (least - apart) * ny
    return vx, vy


@kernel
def pinch(vx, vy, mx, my, nx, ny, ox, oy, wx, wy, separation, wall_restitution):
    """A puck struck by a mallet (velocity `m`, normal `n`) while it touches something else (velocity `o`, normal `w`).

    Both impulses act at once, so that the puck leaves the mallet with `separation` [m/s] and the other with its own
    rebound. Returns `(held, vx, vy)`; `held` is true where the two face each other so squarely that no puck slips out:
    then the motors stall, and what remains is the puck's motion along the wedge, unless that leads deeper into it.
    """
    closing = (mx - vx) * nx + (my - vy) * ny
    rebound = max(wall_restitution * ((ox - vx) * wx + (oy - vy) * wy), LEAST_REBOUND)
    cosine = nx * wx + ny * wy
    sine2 = 1.0 - cosine * cosine
    if sine2 < STEEPEST_WEDGE:
        along = -vx * ny + vy * nx
        slide_x, slide_y = -wall_restitution * along * ny, wall_restitution * along * nx
        return (True, slide_x, slide_y) if slide_x * wx + slide_y * wy >= 0.0 else (True, 0.0, 0.0)
    need_n = closing + separation
    need_w = rebound - ((vx - ox) * wx + (vy - oy) * wy)
    from_mallet = max((need_n - cosine * need_w) / sine2, 0.0)
    from_wall = max((need_w - cosine * need_n) / sine2, 0.0)
    return False, vx + from_mallet * nx + from_wall * wx, vy + from_mallet * ny + from_wall * wy
