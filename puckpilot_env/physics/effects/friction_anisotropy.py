"""The surface has a grain: friction depends on the heading."""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel

_SOURCE = "a documented choice"

EFFECT = Effect(
    regime="glide",
    law="f = friction (1 + ratio (vx^2 - vy^2) / v^2)",
    rows={
        "ratio": Parameter(
            "friction_anisotropy", "1", 0.0, -1.0, 1.0, "more friction along x and less along y, as a share", _SOURCE
        ),
    },
    depends_on=("heading",),
    excited_by="slow glides along x and along y",
    source="the second harmonic of the heading, the first that a grain allows",
)


@kernel
def is_on(p):
    """Whether there is a grain."""
    return p.friction_anisotropy != 0.0


@kernel
def friction(p, t, x, y, dx, dy, friction):
    """By the heading of the way; a resting puck has none."""
    square = dx * dx + dy * dy
    if square == 0.0:
        return friction
    return friction * (1.0 + p.friction_anisotropy * (dx * dx - dy * dy) / square)
