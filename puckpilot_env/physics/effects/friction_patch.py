"""A disc of the table where friction is another: dirt, or holes that blow less."""

from __future__ import annotations

import math

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.interpolation import share_of_time

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
def friction(p, t, x, y, vx, vy, friction):
    """More inside."""
    dx, dy = x - p.patch_x, y - p.patch_y
    return friction + p.patch_extra if dx * dx + dy * dy < p.patch_radius * p.patch_radius else friction


@kernel
def edge(p, t, x, y, v, t1, x1, y1, v1):
    """Where a straight way meets the circle; of a way along which the puck slows down, when."""
    return share_of_time(_way_to_circle(p, x, y, x1, y1), v, v1)


@kernel
def _way_to_circle(p, x, y, x1, y1):
    """The share of the way after which it meets the circle, infinite if it does not."""
    dx, dy = x1 - x, y1 - y
    x, y = x - p.patch_x, y - p.patch_y
    square, half = dx * dx + dy * dy, x * dx + y * dy
    chord = half * half - square * (x * x + y * y - p.patch_radius * p.patch_radius)
    if chord <= 0.0 or square == 0.0:
        return math.inf
    root = math.sqrt(chord)
    if -half - root > 0.0:
        return (-half - root) / square
    return (root - half) / square if root > half else math.inf
