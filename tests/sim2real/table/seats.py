"""The seat of the twin that its tests play, and an action that stays at home."""

from __future__ import annotations

import numpy as np

from sim2real.table.game.robot_seat import RobotSeat
from sim2real.table.twin.twin import Twin

MATCH = "puckpilot/match-v0"
STAY = np.array([0.25, 0.5, 5.0, 5.0], np.float32)


def twin_of(env: RobotSeat) -> Twin:
    """The twin behind a seat."""
    twin = env.backend
    assert isinstance(twin, Twin)
    return twin
