"""A seat at a twin, whose other player stands still."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from sim2real.table.game.robot_seat import RobotSeat, make_robot_seat
from tests.sim2real.table.seats import MATCH


@pytest.fixture
def seat() -> Iterator[RobotSeat]:
    env = make_robot_seat(MATCH, "twin", opponent="still", seed=2)
    yield env
    env.close()
