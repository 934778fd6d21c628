"""Play at the twin's robot seat: games one after another, and how old what a player is shown is."""

from __future__ import annotations

from contextlib import closing
from typing import Any

import numpy as np
import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from puckpilot_env.options.at_table import OBSERVATION_AGE
from sim2real.table.game.game_log import GameLog
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
        log = play_for(env, "interceptor", 3, SECONDS, lambda line: None, lambda fault: True, see)
    return log, scores, ages


def test_a_new_game_begins_where_one_ends_and_all_goals_count(played: Played) -> None:
    log, scores, _ = played
    goals = np.sum([one for one in scores if any(one)], axis=0)  # a game is over with its first
    assert log.score == tuple(goals) and sum(log.score) >= 2
    assert log.outcome == np.sign(log.score[0] - log.score[1])
    assert log.seconds == pytest.approx(SECONDS) and len(scores) == round(SECONDS / 0.1)
    assert log.shots.made >= log.score[0] and log.plans >= len(scores)


def test_what_players_are_shown_is_as_old_as_the_simulator_has_it(played: Played) -> None:
    assert float(np.median(played[2])) == pytest.approx(OBSERVATION_AGE, abs=0.0005)
