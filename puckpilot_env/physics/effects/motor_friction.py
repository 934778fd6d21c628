"""Dry friction of motors and axes: a voltage is lost against the motion, as long as there is any.

The left motor's belt travels with x - y, the right one's with -x - y (report E.1).
"""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter

_SOURCE = "brushes, bearings and belts: half a volt to a volt on a real gantry"


def _lost(name: str, what: str) -> Parameter:
    return Parameter(name, "V", 0.0, -1.0, 6.0, f"volts that {what} loses against its motion", _SOURCE)


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
    not_simulated="friction that reverses with the motion has no plan in closed form",
)
