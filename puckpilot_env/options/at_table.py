"""What is true of every physical table, as parameters of the simulator: who learns with them knows a table's loop.

Late commands are not among them, since players are shown what will be when they act: as far as it can be predicted.
"""

from __future__ import annotations

from collections.abc import Mapping

OPERATING_VOLTS = 15.0  # V that a motor ever gets on a table (report)
FEEDBACK_VOLTS = 1.0  # V of these that plans leave to the board's feedback
BRAKING_TIME = 0.034  # s that braking with all of them may take by the closed form; the board needs up to 3 ms more
PLANNED_BRAKING_TIME = 0.036  # s that the same braking takes with the volts of plans
OBSERVATION_AGE = 0.0205  # s from a frame's exposure until an action that answers it acts
AT_TABLE: Mapping[str, float] = {
    "max_voltage": OPERATING_VOLTS - FEEDBACK_VOLTS, "braking_time": PLANNED_BRAKING_TIME,
    "feedback_voltage": FEEDBACK_VOLTS, "observation_age": OBSERVATION_AGE, "hand": 1.0,
}  # fmt: skip
