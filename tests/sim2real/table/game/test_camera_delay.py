"""A camera's delay that is allowed for: the puck that the player is shown is where it will be when its action acts."""

from __future__ import annotations

from contextlib import closing

import numpy as np
import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from baselines import make_player
from baselines.player import Seat
from sim2real.table.game.robot_seat import make_robot_seat
from sim2real.table.twin.camera import CameraErrors

LATE = 0.015  # s


def error_of(camera_delay: float) -> float:
    """By how much the player's puck is off [m], typically, while it is fast and hit by nobody, on a table whose stamps
    are LATE."""
    options = {"errors": CameraErrors(stamp_late=LATE), "opponent": "interceptor"}
    errors = []
    with closing(make_robot_seat("match-v0", "twin", camera_delay=camera_delay, **options)) as env:
        player = make_player("interceptor", Seat.from_tables(env.tables, 1))
        player.reset(np.ones(1, bool))
        observation, info = env.reset(seed=3)
        for _ in range(80):
            observation, _, _, _, info = env.step(player.act(observation[None])[0])
            shown, true = env.game.record["puck"], env.backend.plant.puck
            velocity, place = true[2:], true[:2] + (info["acts_at"] - info["time"]) * true[2:]
            if np.hypot(*velocity) > 0.5 and np.hypot(shown["vx"] - velocity[0], shown["vy"] - velocity[1]) < 0.1:
                errors.append(np.hypot(shown["x"] - place[0], shown["y"] - place[1]))
    assert len(errors) > 20
    return float(np.median(errors))


@pytest.mark.slow
def test_the_puck_is_where_it_is_shown_if_the_loop_allows_for_the_delay() -> None:
    assert error_of(LATE) < 0.002 and error_of(0.0) > 0.015
