"""The air film changes while one plays: friction grows or falls with time."""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel

_SOURCE = "a blower that warms up: some percent a minute"

EFFECT = Effect(
    regime="glide",
    law="f = friction (1 + rate t)",
    rows={
        "rate": Parameter(
            "air_drift", "1/s", 0.0, -0.02, 0.1, "growth of friction with the time of the episode", _SOURCE
        ),
    },
    depends_on=("time",),
    excited_by="the same slow glides at the beginning and at the end",
    source="a documented choice: linear in time",
)


@kernel
def is_on(p):
    """Whether friction changes."""
    return p.air_drift != 0.0


@kernel
def friction(p, t, x, y, vx, vy, friction):
    """In proportion to the friction so far; never less than none."""
    return friction * max(1.0 + p.air_drift * t, 0.0)
