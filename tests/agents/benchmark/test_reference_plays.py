"""This version plays the protocol's game, and other physics, rules or observations are noticed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from agents.benchmark import reference_plays
from agents.benchmark.reference_plays import departures, record_plays
from baselines.players.corner_shot import CornerShot
from puckpilot_env.tables import Tables


def test_this_version_plays_the_protocols_game() -> None:
    assert departures() == []


def _tables(**options: Any) -> Callable[..., Tables]:
    return lambda variant, count, seed: Tables(variant, count, seed=seed, **options)


@pytest.mark.parametrize(
    ("options", "named"),
    [
        ({"parameters": {"friction": 0.13}}, "observations differ by"),  # physics: 0.125 m/s^2 in the protocol
        ({"reward": "sparse"}, "rewards differ by"),
        ({"max_cycles": 1790}, "observations differ by"),
    ],
)
def test_another_game_is_noticed(options: dict[str, Any], named: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reference_plays, "Tables", _tables(**options))
    found = departures()
    assert any(line.startswith("match-v0: ") and named in line for line in found)


def test_another_observation_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    def seen_otherwise(variant: str, count: int, seed: int) -> Tables:
        return Tables(variant.replace("match-v0", "match-sensors-v0"), count, seed=seed)

    monkeypatch.setattr(reference_plays, "Tables", seen_otherwise)
    assert any(line.startswith("match-v0: observations have shape") for line in departures())


def test_an_opponent_that_plays_otherwise_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(CornerShot, "decide", lambda self, state: np.zeros((len(state.puck), 4)))
    assert any(line.startswith("attack-v0: decisions differ by") for line in departures())


def test_numbers_that_are_none_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    played = reference_plays._played

    def without_numbers(variant: str, actions: np.ndarray) -> dict[str, np.ndarray]:
        return {**played(variant, actions), "rewards": np.full((reference_plays.TABLES, 2), np.nan, np.float32)}

    monkeypatch.setattr(reference_plays, "_played", without_numbers)
    assert len(departures()) == 7


def test_matches_end_in_the_plays_by_the_clock_and_by_points() -> None:
    for name in ("match-v0", "match-randomized-v0", "match-sensors-v0"):
        with np.load(reference_plays.PLAYS) as kept:
            ended = kept[f"{name}.ended"]
        assert (ended[::4] >= 1).all() and ended[1::4].any()


def test_plays_that_are_recorded_anew_are_followed(tmp_path: Any) -> None:
    assert departures(record_plays(tmp_path / "plays.npz")) == []
