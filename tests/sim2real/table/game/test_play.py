"""Play at the twin's robot seat: games one after another, and how old what a player is shown is."""

from __future__ import annotations

from contextlib import closing
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from puckpilot_env import Tables
from puckpilot_env.options.at_table import OBSERVATION_AGE
from sim2real.table.faults import Cause, TableFaultError
from sim2real.table.game.game_log import GameLog
from sim2real.table.game.game_record import GameRecord
from sim2real.table.game.loop import Loop
from sim2real.table.game.play import play_for
from sim2real.table.game.robot_seat import make_robot_seat

SECONDS = 12.0
Played = tuple[GameLog, list[tuple[int, ...]], list[float]]


@pytest.fixture(scope="module")
def played() -> Played:
    """Games to the first goal, for SECONDS: what came of them, the scores of each step, and the age of the newest
    sight of the puck when an action acts [s]."""
    scores: list[tuple[int, ...]] = []
    ages: list[float] = []

    def see(loop: Loop, action: Any, info: dict[str, Any]) -> None:
        scores.append(tuple(int(goals) for goals in info["score"]))
        if loop.seen.puck.state is not None:
            ages.append(info["acts_at"] - loop.seen.puck.state.time)

    with closing(make_robot_seat("match-v0", "twin", opponent="still")) as env:
        env.game.rule["points"] = 1
        log = play_for(env, "interceptor", 6, SECONDS, lambda line: None, lambda fault: True, see)
    return log, scores, ages


def test_a_new_game_begins_where_one_ends_and_all_goals_count(played: Played) -> None:
    log, scores, _ = played
    goals = np.sum([one for one in scores if any(one)], axis=0)  # a game is over with its first
    assert log.score == tuple(goals) and sum(log.score) >= 2
    assert log.outcome == np.sign(log.score[0] - log.score[1])
    unnoticed = sum(log.score)  # steps: each goal is seen one late, which is no play
    assert log.seconds == pytest.approx(SECONDS) and len(scores) == round(SECONDS / 0.1) + unnoticed
    assert log.shots.made >= log.score[0] and log.plans >= len(scores)


def test_a_record_shows_what_was_written_however_late_its_table_is() -> None:
    game = GameRecord("match-v0", {"observation_age": 0.03})
    game.put_puck((0.7, 0.3, 1.0, -0.5))
    np.testing.assert_allclose(game.observe()[0, 5:9], [0.7, 0.3, 1.0, -0.5], atol=1e-6)


class StoppedBetweenGames:
    """A seat whose games last ten steps, and whose table is stopped before the second one begins."""

    def __init__(self, ends: Exception | None = None) -> None:
        self.tables = Tables("match-v0", 1)
        self.observation_space = SimpleNamespace(shape=self.tables.observations.shape[2:])
        self.loop, self.begun, self.steps, self.cleared, self._ends = None, 0, 0, 0, ends

    def seen(self) -> tuple[np.ndarray, dict[str, Any]]:
        info = {
            "time": 0.0, "score": np.array([1, 0]), "fouls": np.zeros(2, int), "new_point": False, "off_path": 0.0,
            "play_time": 0.1 * self.steps, "plans": self.steps, "parked": 0.0,
        }  # fmt: skip
        return self.tables.observations[0, 0], info

    def reset(self, seed: int | None = None) -> tuple[np.ndarray, dict[str, Any]]:
        self.begun, self.steps = self.begun + 1, 0
        if self.begun == 2:
            raise self._ends or TableFaultError(Cause.PUCK_LOST, "the puck is not seen")
        return self.seen()

    def clear(self) -> tuple[np.ndarray, dict[str, Any]]:
        self.cleared += 1
        return self.seen()

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        self.steps += 1
        observation, info = self.seen()
        return observation, 0.0, self.steps == 10, False, info


def play_out(env: StoppedBetweenGames, clears: bool) -> GameLog:
    return play_for(env, "still", 0, 2.5, lambda line: None, lambda fault: clears, lambda *seen: None)  # type: ignore[arg-type] - all that it asks for


def test_a_table_that_is_stopped_between_games_is_cleared() -> None:
    env = StoppedBetweenGames()
    log = play_out(env, clears=True)
    assert (env.begun, env.cleared, log.faults) == (3, 1, [str(Cause.PUCK_LOST)])
    assert log.score == (3, 0) and log.seconds == pytest.approx(2.5)


def test_a_table_that_is_not_cleared_between_games_is_a_fault() -> None:
    with pytest.raises(TableFaultError, match="not seen"):
        play_out(StoppedBetweenGames(), clears=False)


def test_a_game_that_ended_before_it_began_leaves_what_was_counted() -> None:
    first = GameLog(score=(2, 1), seconds=10.0, plans=100, parked=0.5, outcome=1)
    both = first.with_next(GameLog(interrupted=True))
    assert (both.score, both.seconds, both.plans, both.parked, both.interrupted) == ((2, 1), 10.0, 100, 0.5, True)


def test_what_players_are_shown_is_as_old_as_the_simulator_has_it(played: Played) -> None:
    assert float(np.median(played[2])) == pytest.approx(OBSERVATION_AGE, abs=0.0005)
