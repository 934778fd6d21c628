"""The air film drags at the puck: a force in proportion to the speed."""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel

_SOURCE = "a sheared air film of 50 um under a 30 g puck gives 0.04 1/s"

EFFECT = Effect(
    regime="glide",
    law="a = -k v",
    rows={
        "k": Parameter("linear_drag", "1/s", 0.0, 0.0, 2.0, "drag per unit speed and mass", _SOURCE),
    },
    depends_on=("speed",),
    excited_by="glides of all speeds, slow ones above all",
    source="Couette flow in the film, force proportional to speed",
)


@kernel
def is_on(p):
    """Whether there is such a drag."""
    return p.linear_drag != 0.0


@kernel
def acceleration(p, t, x, y, vx, vy, spin):
    """Against the velocity."""
    return -p.linear_drag * vx, -p.linear_drag * vy
