"""The surface has a grain: friction depends on the heading, and need not point straight back."""

from __future__ import annotations

import math

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel

_SOURCE = "a documented choice"

EFFECT = Effect(
    regime="glide",
    law="along: -friction (1 + grain cos 2 heading), across: friction turning sin 2 heading",
    rows={
        "grain": Parameter(
            "friction_anisotropy", "1", 0.0, -1.0, 1.0, "more friction along x and less along y, as a share", _SOURCE
        ),
        "turning": Parameter(
            "friction_turning", "1", 0.0, -1.0, 1.0, "share of friction that turns a slanted puck to the left", _SOURCE
        ),
    },
    depends_on=("heading",),
    excited_by="slow glides along x, along y and slanted",
    source="the second harmonic of the heading, the first that a grain allows; equal shares make a friction of two "
    "components, each with a coefficient of its own",
)


@kernel
def is_on(p):
    """Whether there is a grain."""
    return p.friction_anisotropy != 0.0 or p.friction_turning != 0.0


@kernel
def friction(p, t, x, y, vx, vy, friction):
    """By the heading; a resting puck has none."""
    square = vx * vx + vy * vy
    if square == 0.0:
        return friction
    return friction * (1.0 + p.friction_anisotropy * (vx * vx - vy * vy) / square)


@kernel
def acceleration(p, t, x, y, vx, vy, spin):
    """The part across the velocity; a resting puck has none."""
    square = vx * vx + vy * vy
    if square == 0.0:
        return 0.0, 0.0
    across = p.friction * p.friction_turning * 2.0 * vx * vy / (square * math.sqrt(square))
    return -across * vy, across * vx
