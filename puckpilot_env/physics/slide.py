"""Free sliding under the forces of the effects, for which there is no closed form.

Time is cut into short intervals. In each the forces act as two kicks, half at its beginning and half at its end, and
between them the puck glides along a straight line by the baseline's law (`glide`), with the friction that the effects
make of it on that way: second-order splitting (Strang 1968). An interval is short against the time in which the
puck may stop or turn, since friction changes its direction there.
"""

from __future__ import annotations

import math

from puckpilot_env.kernel import kernel
from puckpilot_env.physics import compose, glide
from puckpilot_env.physics.vector import size

LONGEST, SHORTEST = 4e-3, 2e-5  # s, of an interval
SHARE = 0.25  # of the time to a stop or a turn, that an interval may take


@kernel
def force(puck, p, t, vx, vy):
    """Acceleration (ax, ay) [m/s^2] by the effects' forces on the puck, if its velocity is `v`, at the time `t`."""
    if puck.turned == 0:
        return compose.acceleration(p, t, puck.x, puck.y, vx, vy, puck.spin)
    ax, ay = compose.acceleration(p, t, p.length - puck.x, p.width - puck.y, -vx, -vy, puck.spin)
    return -ax, -ay


@kernel
def friction_on_way(puck, p, t, dx, dy):
    """Mean friction [m/s^2] at about the time `t` on the puck's way on by (dx, dy) [m]."""
    x, y = puck.x, puck.y
    if puck.turned != 0:
        x, y, dx, dy = p.length - x, p.width - y, -dx, -dy
    return max(compose.friction(p, t, x, y, dx, dy, p.friction), 0.0)


@kernel
def plan_interval(puck, p, t, ax, ay):
    """`(pull, duration [s])` of the next interval of a puck that the forces pull by `a` [m/s^2].

    `pull` is the share of the forces that friction leaves: 1 while the puck moves; from a rest, friction is taken off
    the forces and acts no more in this interval; 0 where it holds the puck.
    """
    v = size(puck.vx, puck.vy)
    force = size(ax, ay)
    friction = friction_on_way(puck, p, t, puck.vx * SHORTEST, puck.vy * SHORTEST)
    if v == 0.0:
        return (1.0 - friction / force if force > friction else 0.0), LONGEST
    forward = (ax * puck.vx + ay * puck.vy) / v
    turn = abs(ay * puck.vx - ax * puck.vy) / v
    change = turn + max(friction - 0.5 * forward, 0.0)
    return 1.0, min(max(SHARE * v / change, SHORTEST) if change > 0.0 else LONGEST, LONGEST)


@kernel
def kicked(puck, p, t, vx, vy, pull, duration):
    """The velocity `v` after the forces alone acted for `duration` [s], which may be negative, at the puck's place."""
    ax, ay = force(puck, p, t, vx, vy)
    half = 0.5 * duration * pull
    ax, ay = force(puck, p, t, vx + half * ax, vy + half * ay)
    return vx + duration * pull * ax, vy + duration * pull * ay


@kernel
def interval_law(puck, p, t, vx, vy, pull, duration):
    """`(friction, drag)` of the straight part of an interval that begins with the velocity `v`."""
    if pull != 1.0:
        return 0.0, 0.0
    v = size(vx, vy)
    way = glide.distance(v, duration, p.friction, p.drag) / v if v > 0.0 else 0.0
    return friction_on_way(puck, p, t + 0.5 * duration, way * vx, way * vy), p.drag


@kernel
def move(puck, p, ux, uy, v, duration, friction, drag):
    """Glide along the unit vector `u` from the speed `v` [m/s]; the spin dies out meanwhile."""
    path_length, speed = glide.advance(v, duration, friction, drag)
    puck.x += ux * path_length
    puck.y += uy * path_length
    puck.vx = ux * speed
    puck.vy = uy * speed
    if puck.spin != 0.0:
        puck.spin *= math.exp(-p.spin_decay * duration)


@kernel
def finish(puck, p, t, pull, duration):
    """The kick that ends an interval; friction that has stopped the puck holds it for now."""
    if puck.vx != 0.0 or puck.vy != 0.0:
        puck.vx, puck.vy = kicked(puck, p, t, puck.vx, puck.vy, pull, duration)


@kernel
def slide(puck, p, t, duration):
    """Let a puck (record of `advance.PUCK`) slide for `duration` [s] from the time `t` of the episode, in place.

    Baseline and all effects of the glide; neither walls nor mallets.
    """
    forced = compose.is_forced(p)
    left = duration
    while left > 0.0:
        pull, h = 1.0, left
        vx, vy, friction, drag = puck.vx, puck.vy, p.friction, p.drag
        if forced:
            ax, ay = force(puck, p, t, puck.vx, puck.vy)
            pull, longest = plan_interval(puck, p, t, ax, ay)
            h = min(h, longest)
            vx, vy = kicked(puck, p, t, puck.vx, puck.vy, pull, 0.5 * h)
            friction, drag = interval_law(puck, p, t, vx, vy, pull, h)
        v = math.sqrt(vx * vx + vy * vy)
        ux, uy = (vx / v, vy / v) if v > 0.0 else (1.0, 0.0)
        move(puck, p, ux, uy, v, h, friction, drag)
        t, left = t + h, left - h
        if forced:
            finish(puck, p, t, pull, 0.5 * h)
