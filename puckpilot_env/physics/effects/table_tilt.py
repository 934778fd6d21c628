"""The table is not level: a constant acceleration along its surface."""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel

_SOURCE = "0.05 degrees found on a real table; 0.2 m/s^2 is 1.2 degrees"

EFFECT = Effect(
    regime="glide",
    law="a = (tilt_x, tilt_y)",
    rows={
        "tilt_x": Parameter("tilt_x", "m/s^2", 0.0, -0.2, 0.2, "downhill acceleration along x", _SOURCE),
        "tilt_y": Parameter("tilt_y", "m/s^2", 0.0, -0.2, 0.2, "downhill acceleration along y", _SOURCE),
    },
    depends_on=("heading",),
    excited_by="slow glides in all directions",
    source="gravity on an incline, g sin(angle)",
)


@kernel
def is_on(p):
    """Whether the table is tilted."""
    return p.tilt_x != 0.0 or p.tilt_y != 0.0


@kernel
def acceleration(p, t, x, y, vx, vy, spin):
    """The same everywhere and always."""
    return p.tilt_x, p.tilt_y
