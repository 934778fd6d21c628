"""One wall bounces unlike the others."""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.contacts import bounce

_SOURCE = "a documented choice"

EFFECT = Effect(
    regime="wall",
    law="e = e0 + delta of that wall",
    rows={
        "x0": Parameter(
            "restitution_x0", "1", 0.0, -0.5, 0.5, "restitution of the robot's short wall less the common one", _SOURCE
        ),
        "x1": Parameter(
            "restitution_x1",
            "1",
            0.0,
            -0.5,
            0.5,
            "restitution of the opponent's short wall less the common one",
            _SOURCE,
        ),
        "y0": Parameter(
            "restitution_y0",
            "1",
            0.0,
            -0.5,
            0.5,
            "restitution of the robot's right-hand wall less the common one",
            _SOURCE,
        ),
        "y1": Parameter(
            "restitution_y1",
            "1",
            0.0,
            -0.5,
            0.5,
            "restitution of the robot's left-hand wall less the common one",
            _SOURCE,
        ),
    },
    depends_on=("position",),
    excited_by="many hits of every wall",
    source="a documented choice: constants",
)


@kernel
def restitution(p, kind, closing, e):
    """A constant of each wall."""
    if kind == bounce.WALL_X0:
        return e + p.restitution_x0
    if kind == bounce.WALL_X1:
        return e + p.restitution_x1
    if kind == bounce.WALL_Y0:
        return e + p.restitution_y0
    if kind == bounce.WALL_Y1:
        return e + p.restitution_y1
    return e
