"""A disc of the table where friction is another: dirt, or holes that blow less."""

from __future__ import annotations

import math

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel

_SOURCE = "blocked holes cost up to the whole film: tenths of m/s^2"

EFFECT = Effect(
    regime="glide",
    law="f = friction + extra inside the disc",
    rows={
        "x": Parameter("patch_x", "m", 0.0, 0.0, 4.0, "the disc's middle, x", _SOURCE),
        "y": Parameter("patch_y", "m", 0.0, 0.0, 2.0, "the disc's middle, y", _SOURCE),
        "radius": Parameter("patch_radius", "m", 0.0, 0.0, 2.0, "the disc's radius", _SOURCE),
        "extra": Parameter("patch_extra", "m/s^2", 0.0, -5.0, 5.0, "friction inside less that outside", _SOURCE),
    },
    depends_on=("position",),
    excited_by="glides that cross the place from several sides",
    source="a documented choice: a sharp edge",
)


@kernel
def is_on(p):
    """Whether there is such a disc."""
    return p.patch_extra != 0.0


@kernel
def friction(p, t, x, y, dx, dy, friction):
    """More by the share of the way that lies inside."""
    return friction + p.patch_extra * share_inside(x - p.patch_x, y - p.patch_y, dx, dy, p.patch_radius)


@kernel
def share_inside(x, y, dx, dy, radius):
    """Share of the way from (x, y) on by (dx, dy) that is less than `radius` from the origin; of a point, 0 or 1."""
    square = dx * dx + dy * dy
    room = radius * radius - x * x - y * y
    if square == 0.0:
        return 1.0 if room > 0.0 else 0.0
    nearest = -(x * dx + y * dy) / square
    reach2 = nearest * nearest + room / square
    if reach2 <= 0.0:
        return 0.0
    reach = math.sqrt(reach2)
    return max(min(nearest + reach, 1.0) - max(nearest - reach, 0.0), 0.0)
