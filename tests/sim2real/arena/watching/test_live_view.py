"""What is shown of a game at a table is what its loop knows, at the pace of the clock on the wall."""

from __future__ import annotations

import json
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from sim2real.arena.watching.live_view import LiveView, Pace
from sim2real.table.game.loop import Loop
from sim2real.table.game.play import play_for
from sim2real.table.game.robot_seat import make_robot_seat

SECONDS = 4.0


class Wall:
    """A clock of the test's own, which goes on while somebody sleeps."""

    def __init__(self) -> None:
        self.time = 100.0

    def sleep(self, seconds: float) -> None:
        self.time += seconds


def stamps(held: bool, costs: list[float], step: float = 0.1) -> tuple[list[float], list[float]]:
    """Stamps of views [s] of every `step` [s] of a table's time, if a step takes so much of the wall's, and when they
    come by the wall [s]."""
    wall, found, came = Wall(), [], []
    pace = Pace(held, lambda: wall.time, wall.sleep)
    for number, cost in enumerate(costs):
        wall.time += cost
        found.append(pace.stamp(number * step))
        came.append(wall.time - 100.0)
    return found, came


def test_a_fast_twin_waits_for_the_wall_and_a_table_waits_for_nobody() -> None:
    found, came = stamps(True, [0.0] + [0.01] * 5)
    assert found == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.4, 0.5]) and came == pytest.approx(found)
    found, came = stamps(False, [0.0] + [0.01] * 5)
    assert found == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.4, 0.5]) and came[-1] == pytest.approx(0.05)


def test_a_slow_twin_is_shown_as_slow_as_it_is_and_makes_nothing_up() -> None:
    found, came = stamps(True, [0.0] + [0.3] * 5 + [0.01] * 5)
    assert found[:6] == pytest.approx(came[:6], abs=0.021) and found[5] == pytest.approx(1.5, abs=0.021)
    assert np.diff(found[6:]) == pytest.approx([0.1] * 4) and np.diff(came[6:]) == pytest.approx([0.1] * 4)


@pytest.mark.slow
def test_what_is_shown_is_what_the_loop_knows_frame_by_frame() -> None:
    """Against the twin's truth, a tenth of a millimetre of noise away, and the record of the score."""
    said: list[dict[str, Any]] = []
    truth: list[tuple[float, ...]] = []
    view = LiveView(("interceptor", "goalie"), lambda message: said.append(json.loads(message)), Pace(False))
    env = make_robot_seat("match-v0", "twin", opponent="goalie")

    def see(loop: Loop) -> None:
        before = len(said)
        view.see(loop)
        if len(said) > before and said[-1]["kind"] == "state":
            plant: Any = loop.backend.plant  # type: ignore[attr-defined]
            truth.append((*plant.puck[:2], *plant.mallet(0)[:2], *plant.mallet(1)[:2]))

    env.onlooker = see
    try:
        play_for(env, "interceptor", 3, SECONDS, lambda line: None, lambda fault: False, lambda *step: None)
        score = env.game.record["score"].tolist()
    finally:
        env.close()
    welcome, *states = said
    assert welcome["kind"] == "welcome" and welcome["names"] == ["interceptor", "goalie"] and welcome["seat"] is None
    assert welcome["again"] is False and welcome["table"]["length"] == 2.0
    times = np.array([one["time"] for one in states])
    assert (np.diff(times) > 0.0).all() and len(states) > 40 * SECONDS
    assert states[-1]["score"] == score and states[-1]["left"] == pytest.approx(180.0 - SECONDS, abs=0.2)
    rows = [[*(one["puck"] or (math.nan,) * 2), *one["mallets"][0], *(one["mallets"][1] or (math.nan,) * 2)]
            for one in states]  # fmt: skip
    off = np.abs(np.array(rows) - np.array(truth))
    assert np.isfinite(off).all(axis=1).mean() > 0.8
    assert np.nanquantile(off, 0.9) < 0.003 and np.nanmax(off[:, 2:4]) < 0.005


def test_pages_of_two_loops_see_one_time_that_goes_on() -> None:
    said: list[dict[str, Any]] = []
    view = LiveView(("a", "b"), lambda message: said.append(json.loads(message)), Pace(False, lambda: 0.0))
    for _ in range(2):  # each begins at 0 anew
        env = SimpleNamespace(now=0.0)
        loop = imagined(env)
        for frame in range(30):
            env.now = frame / 120.0
            view.see(loop)
    kinds = [one["kind"] for one in said]
    assert kinds.count("welcome") == 2
    times = [one["time"] for one in said if one["kind"] == "state"]
    assert len(times) > 25 and (np.diff(times) > 0.0).all() and times[-1] == pytest.approx(29 / 60.0, abs=0.02)


def imagined(env: Any) -> Any:
    """A loop at which nothing is seen, with a clock of the test's."""
    from sim2real.table.game.game_record import GameRecord
    from sim2real.table.game.moving_objects import SeenTable

    game = GameRecord("match-v0")
    game.tables.reset(0)
    backend = SimpleNamespace(now=lambda: env.now)
    return SimpleNamespace(backend=backend, game=game, seen=SeenTable(game.p), motion=lambda time: (0.3, 0.5, 0.0, 0.0))
