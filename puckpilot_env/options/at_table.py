"""What is true of every physical table, as parameters of the simulator: who learns with them knows a table's loop.

The loop's own delay is not among them, since players are shown what will be when they act.
"""

from __future__ import annotations

from collections.abc import Mapping

OPERATING_VOLTS = 15.0  # V that a motor ever gets on a table (report)
BRAKING_TIME = 0.034  # s that braking may take by the closed form; the board needs up to 3 ms more
AT_TABLE: Mapping[str, float] = {"max_voltage": OPERATING_VOLTS, "braking_time": BRAKING_TIME, "hand": 1.0}
