"""Walls that are turned against the drawing, so that a table is wider at one end than at the other.

A puck bounces where the straight wall is, off a surface that is turned: of the two consequences of a wall that is not
parallel to its axis, directions count for much more on a table than places, by which the wall is off by a millimetre.
"""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.contacts import bounce

_SOURCE = "wooden tables are out of square by millimetres a metre"
_MOST = 0.02  # rad, 4 cm over a table's length


def _angle(wall: str, words: str) -> Parameter:
    meaning = f"how far {words} wall is turned counter-clockwise"
    return Parameter(f"wall_angle_{wall}", "rad", 0.0, -_MOST, _MOST, meaning, _SOURCE)


EFFECT = Effect(
    regime="wall",
    law="the normal of each wall is turned by its angle",
    rows={
        "x0": _angle("x0", "the robot's short"),
        "x1": _angle("x1", "the opponent's short"),
        "y0": _angle("y0", "the robot's right-hand"),
        "y1": _angle("y1", "the robot's left-hand"),
    },
    depends_on=("position",),
    excited_by="many hits of every wall",
    source="geometry of a reflection",
)


@kernel
def angle(p, kind):
    """A constant of each wall; none of a post."""
    if kind == bounce.WALL_X0:
        return p.wall_angle_x0
    if kind == bounce.WALL_X1:
        return p.wall_angle_x1
    if kind == bounce.WALL_Y0:
        return p.wall_angle_y0
    if kind == bounce.WALL_Y1:
        return p.wall_angle_y1
    return 0.0
