"""What a table's board gives back of the volts that its gantry loses: feedback holds the mallet on its plan.

The parameter `feedback_voltage` says with how many volts at each motor, beyond those of the plan. They make up for dry
friction first, whatever the motion, and for a supply that sags with what is left of them. Nothing else is held.
"""

from __future__ import annotations

from puckpilot_env.kernel import kernel
from puckpilot_env.physics import compose


@kernel
def _most_friction(p):
    """The most [V] that dry friction takes of a motor: its own, and half of both axes', of which it drives each with
    half of its volts."""
    left, right, along_x, along_y = compose.dry_friction(p)
    return max(left, right) + 0.5 * (along_x + along_y)


@kernel
def friction_left(p):
    """Dry friction as in `compose.dry_friction`, less what is held."""
    left, right, along_x, along_y = compose.dry_friction(p)
    most = _most_friction(p)
    if most == 0.0:
        return left, right, along_x, along_y
    share = max(1.0 - p.feedback_voltage / most, 0.0)
    return share * left, share * right, share * along_x, share * along_y


@kernel
def delivered(p, volts_x, volts_y):
    """The volts (x, y) of the axes that arrive of a plan's. The motors have V1 and V2, the axes V1 - V2 and -V1 - V2
    (report E.1)."""
    load = abs(volts_x) + abs(volts_y)
    lost_x = volts_x - compose.delivered(p, volts_x, load)
    lost_y = volts_y - compose.delivered(p, volts_y, load)
    spare = max(p.feedback_voltage - _most_friction(p), 0.0)
    first = _beyond(0.5 * (lost_x - lost_y), spare)
    second = _beyond(0.5 * (-lost_x - lost_y), spare)
    return volts_x - (first - second), volts_y - (-first - second)


@kernel
def _beyond(lost, spare):
    """What is lost [V] beyond what may be given back."""
    return lost - min(max(lost, -spare), spare)
