"""The first volts are lost: a motor at rest or in motion gives nothing for them."""

from __future__ import annotations

import math

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel

_SOURCE = "brushes and bearings: tenths of a volt to some volts"

EFFECT = Effect(
    regime="gantry",
    law="sign(V) max(|V| - V_lost, 0)",
    rows={"V": Parameter("motor_deadband", "V", 0.0, 0.0, 6.0, "volts lost before a motor pulls", _SOURCE)},
    depends_on=("command",),
    excited_by="moves with few volts beside moves with many",
    source="stiction of a motor as a voltage",
)


@kernel
def loses(p):
    """Whether any volts are lost."""
    return p.motor_deadband != 0.0


@kernel
def delivered(p, volts, load):
    """What is left [V] of `volts`."""
    return math.copysign(max(abs(volts) - p.motor_deadband, 0.0), volts)
