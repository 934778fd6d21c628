"""A force across the velocity, with or without spin."""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel

_SOURCE = "a documented choice; Magnus forces on pucks are weak"

EFFECT = Effect(
    regime="glide",
    law="a = (k + c spin) (-vy, vx)",
    rows={
        "coefficient": Parameter("side_force", "1/s", 0.0, -2.0, 2.0, "acceleration to the left for each m/s", _SOURCE),
        "spin_coefficient": Parameter(
            "spin_side_force", "1", 0.0, -0.1, 0.1, "the same for each rad/s of spin and m/s", _SOURCE
        ),
    },
    depends_on=("speed", "heading", "history"),
    excited_by="long fast glides, with and without wall hits before",
    source="a Magnus force is proportional to spin and speed",
)


@kernel
def is_on(p):
    """Whether there is such a force."""
    return p.side_force != 0.0 or p.spin_side_force != 0.0


@kernel
def acceleration(p, t, x, y, vx, vy, spin):
    """To the left of the velocity."""
    across = p.side_force + p.spin_side_force * spin
    return -across * vy, across * vx
