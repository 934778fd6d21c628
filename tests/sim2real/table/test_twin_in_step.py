"""Twin and simulator in step: decisions a period apart to microseconds, and a puck that rests until play goes on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from sim2real.table.game.game_record import GameRecord
from sim2real.table.game.robot_seat import RobotSeat, make_robot_seat
from sim2real.table.mallet_driver import AHEAD
from sim2real.table.twin.twin import law_of
from tests.sim2real.table.seats import MATCH, STAY, twin_of

PERIOD = 0.1
TILT = 0.5  # m/s^2


def test_decisions_are_a_period_apart(seat: RobotSeat) -> None:
    _, info = seat.reset(seed=1)
    decided = [info["time"]]
    for _ in range(6):
        *_, info = seat.step(STAY)
        decided.append(info["time"])
    np.testing.assert_allclose(np.diff(decided), PERIOD, atol=1e-5)


@pytest.fixture
def tilted() -> RobotSeat:
    law = replace(law_of(GameRecord(MATCH).p), tilt_x=-TILT, hand=True)
    return make_robot_seat(MATCH, "twin", opponent="still", law=law)


def test_a_puck_put_down_at_rest_is_held_until_the_first_action_acts(tilted: RobotSeat) -> None:
    try:
        tilted.reset(seed=1)
        plant, loop, put = twin_of(tilted).plant, tilted.loop, (1.4, 0.7, 0.0, 0.0)
        assert loop is not None
        tilted.game.put_puck(put)
        loop.begin_point()
        assert plant.puck == pytest.approx(put, abs=1e-12)
        tilted.step(STAY)
        slid, slope = PERIOD - AHEAD, TILT - float(tilted.game.p["friction"])
        assert plant.puck[2] == pytest.approx(-slope * slid, rel=0.01)
        assert plant.puck[0] - put[0] == pytest.approx(-0.5 * slope * slid**2, rel=0.01)
    finally:
        tilted.close()


def test_a_puck_that_is_put_down_in_motion_is_not_held(tilted: RobotSeat) -> None:
    try:
        tilted.reset(seed=1)  # a first face-off, with a small velocity
        assert np.hypot(*twin_of(tilted).plant.puck[2:]) > 0.2
    finally:
        tilted.close()
