"""Dry friction of motors and axes: a voltage is lost against the motion, as long as there is any.

The left motor's belt travels with x - y, the right one's with -x - y (report E.1). What stands is held by as many volts
as it takes, up to those.
"""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel

_SOURCE = "brushes, bearings and belts: half a volt to a volt on a real gantry"


def _lost(name: str, what: str) -> Parameter:
    return Parameter(name, "V", 0.0, -1.0, 6.0, f"volts that {what} loses against its motion; below 0 none", _SOURCE)


EFFECT = Effect(
    regime="gantry",
    law="V_x - V_left s(x' - y') + V_right s(-x' - y') - V_x s(x'), and so for y; s: the sign",
    rows={
        "V_left": _lost("motor_friction_left", "the left motor"),
        "V_right": _lost("motor_friction_right", "the right motor"),
        "V_x": _lost("axis_friction_x", "the x axis"),
        "V_y": _lost("axis_friction_y", "the y axis"),
    },
    depends_on=("speed", "heading"),
    excited_by="moves in all directions, slow ones and fast ones",
    source="Coulomb (1785), as volts of the motor that overcome it",
)


@kernel
def in_pieces(p):
    """Whether there is such friction: its sign changes within a plan."""
    most = max(p.motor_friction_left, p.motor_friction_right, p.axis_friction_x, p.axis_friction_y)
    return most > 0.0


@kernel
def dry_friction(p):
    """Volts that the left and the right motor, the x and the y axis lose; less than none is none."""
    return (
        max(p.motor_friction_left, 0.0),
        max(p.motor_friction_right, 0.0),
        max(p.axis_friction_x, 0.0),
        max(p.axis_friction_y, 0.0),
    )
