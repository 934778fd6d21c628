"""What the effects of the glide, friction and drag do to a puck at one instant."""

from __future__ import annotations

import math

from puckpilot_env.kernel import inlined_kernel, kernel
from puckpilot_env.physics import compose
from puckpilot_env.physics.vector import size


@inlined_kernel
def push_and_friction(p, turned, t, x, y, vx, vy, spin):
    """`(ax, ay, friction)` [m/s^2] of a puck at (x, y) [m] of velocity `v`: its effects' forces added up, and friction.

    `turned` is 1 where the table, and with it every effect, is turned round; `t` [s] is the time of the episode.
    """
    if turned == 0:
        ax, ay = compose.acceleration(p, t, x, y, vx, vy, spin)
        return ax, ay, max(compose.friction(p, t, x, y, vx, vy, p.friction), 0.0)
    x, y = p.length - x, p.width - y
    ax, ay = compose.acceleration(p, t, x, y, -vx, -vy, spin)
    return -ax, -ay, max(compose.friction(p, t, x, y, -vx, -vy, p.friction), 0.0)


@kernel
def push(puck, p, t):
    """The effects' forces (ax, ay) [m/s^2] on a puck as it moves at the time `t`."""
    ax, ay, _ = push_and_friction(p, puck.turned, t, puck.x, puck.y, puck.vx, puck.vy, puck.spin)
    return ax, ay


@inlined_kernel
def acceleration(p, turned, t, x, y, vx, vy, spin, free_x, free_y):
    """dv/dt (ax, ay) [m/s^2] by all of them; from a rest, what friction leaves of the forces.

    `free_x` and `free_y` are 1, or 0 along an axis on which a wall holds the puck against the forces.
    """
    ax, ay, friction = push_and_friction(p, turned, t, x, y, vx, vy, spin)
    ax, ay = free_x * ax, free_y * ay
    square = vx * vx + vy * vy
    if square == 0.0:
        force = size(ax, ay)
        kept = 1.0 - friction / force if force > friction else 0.0
        return kept * ax, kept * ay
    v = math.sqrt(square)
    loss = friction / v + p.drag * v
    return ax - loss * vx, ay - loss * vy
