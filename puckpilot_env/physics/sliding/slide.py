"""Free sliding of a puck, with neither walls nor mallets: the closed form, or legs where effects force it."""

from __future__ import annotations

import math

from puckpilot_env.kernel import kernel
from puckpilot_env.physics import compose
from puckpilot_env.physics.sliding import glide
from puckpilot_env.physics.sliding.leg import leg


@kernel
def move(puck, p, ux, uy, v, duration, friction, drag):
    """Glide along the unit vector `u` from the speed `v` [m/s]; the spin dies out meanwhile."""
    path_length, speed = glide.advance(v, duration, friction, drag)
    puck.x += ux * path_length
    puck.y += uy * path_length
    puck.vx = ux * speed
    puck.vy = uy * speed
    fade_spin(puck, p, duration)


@kernel
def fade_spin(puck, p, duration):
    """Let the spin die out for `duration` [s]."""
    if puck.spin != 0.0:
        puck.spin *= math.exp(-p.spin_decay * duration)


@kernel
def slide(puck, p, t, duration):
    """Let a puck (record of `advance.PUCK`) slide for `duration` [s] from the time `t` of the episode, in place.

    Baseline and all effects of the glide; neither walls nor mallets.
    """
    if not compose.is_forced(p):
        v = math.sqrt(puck.vx * puck.vx + puck.vy * puck.vy)
        ux, uy = (puck.vx / v, puck.vy / v) if v > 0.0 else (1.0, 0.0)
        if duration > 0.0:
            move(puck, p, ux, uy, v, duration, p.friction, p.drag)
        return
    left = duration
    while left > 0.0:
        h, _, _, puck.x, puck.y, puck.vx, puck.vy, _, _ = leg(puck, p, t, left, 1.0, 1.0)
        fade_spin(puck, p, h)
        t, left = t + h, left - h
