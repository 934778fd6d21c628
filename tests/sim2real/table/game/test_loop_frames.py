"""When the loop decides: on a frame, and after periods of one length, the first of a point among them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim2real.table.game.game_record import GameRecord
from sim2real.table.game.loop import Loop
from sim2real.table.game.warm_up import ImaginedTable

PERIOD = 0.1


class FramedTable(ImaginedTable):
    """An imagined table on which time passes from frame to frame."""

    def wait_for_frame(self, until: float) -> None:
        """Go on to the next frame, or to `until` [s]."""
        self.wait(min(until, self.next_frame()))

    def next_frame(self) -> float:
        """When the next frame comes [s]."""
        return (math.floor(self.now() * self.frame_rate + 1e-6) + 1.0) / self.frame_rate


@pytest.mark.parametrize("begins_at", [0.0, 0.002, 0.0041, 0.007])
def test_a_decision_comes_with_a_frame_and_a_period_after_the_one_before(begins_at: float) -> None:
    game = GameRecord("match-v0")
    table = FramedTable(game.p)
    loop = Loop(table, game)
    loop.connect()
    game.tables.reset(0)
    table.wait(begins_at)  # a person puts the puck down at any moment
    loop.begin_point()
    decided = [table.now()]
    for _ in range(5):
        loop.step(game.tables.action_bounds.mean(axis=0).astype(np.float32))
        decided.append(table.now())
    frames = np.array(decided) * table.frame_rate
    np.testing.assert_allclose(frames, np.round(frames), atol=1e-3)
    np.testing.assert_allclose(np.diff(decided), PERIOD, atol=1e-6)
