"""The table is not flat: a quadratic surface about its middle."""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel

_SOURCE = "a bowl of 1 mm over 1 m is 0.08 1/s^2"

EFFECT = Effect(
    regime="glide",
    law="a = -(warp_xx dx + warp_xy dy, warp_xy dx + warp_yy dy), d from the table's middle",
    rows={
        "warp_xx": Parameter(
            "warp_xx", "1/s^2", 0.0, -1.0, 1.0, "pull back to the middle along x for each m off it", _SOURCE
        ),
        "warp_yy": Parameter(
            "warp_yy", "1/s^2", 0.0, -1.0, 1.0, "pull back to the middle along y for each m off it", _SOURCE
        ),
        "warp_xy": Parameter(
            "warp_xy", "1/s^2", 0.0, -1.0, 1.0, "pull along either axis for each m off along the other", _SOURCE
        ),
    },
    depends_on=("position",),
    excited_by="slow glides all over the table",
    source="gravity on a quadratic surface, to first order in its slope",
)


@kernel
def is_on(p):
    """Whether the table is warped."""
    return p.warp_xx != 0.0 or p.warp_yy != 0.0 or p.warp_xy != 0.0


@kernel
def acceleration(p, t, x, y, vx, vy, spin):
    """Linear in the place."""
    dx, dy = x - 0.5 * p.length, y - 0.5 * p.width
    return -(p.warp_xx * dx + p.warp_xy * dy), -(p.warp_xy * dx + p.warp_yy * dy)
