"""Rounds in which the critic alone learns: the actor stays as it began, then both learn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from agents.training.preset import Preset, read_preset
from agents.training.run import Training
from tests.agents.training.tiny import TINY, training


def critic_first(rounds: int = 2) -> Preset:
    return read_preset(f"critic_rounds = {rounds}\naverage = 4\n{TINY}", "tiny")


def weights(run: Training, network: str) -> np.ndarray:
    parts = getattr(run.runner.alg, network).state_dict().values()
    return np.concatenate([part.detach().numpy().ravel() for part in parts])


def test_the_actor_stays_as_it_is_while_the_critic_learns(tmp_path: Path) -> None:
    run = training(tmp_path, preset=critic_first())
    begun, player = {name: weights(run, name) for name in ("actor", "critic")}, run.policy().network.weights[0]
    for number in range(3):
        run.round()
        assert np.array_equal(weights(run, "actor"), begun["actor"]) == (number < 2)
        assert np.abs(weights(run, "critic") - begun["critic"]).max() > 1e-5
        assert np.array_equal(run.policy().network.weights[0], player) == (number < 2)


def test_a_run_that_was_stopped_before_the_actor_learns_equals_an_unbroken_one(tmp_path: Path) -> None:
    unbroken = training(tmp_path / "a", preset=critic_first())
    for _ in range(3):
        unbroken.round()
    training(tmp_path / "b", preset=critic_first()).round()
    resumed = training(tmp_path / "b", preset=critic_first(), resume=True)
    for _ in range(2):
        resumed.round()
    for name in ("actor", "critic"):
        np.testing.assert_array_equal(weights(unbroken, name), weights(resumed, name))


def test_a_count_that_is_none_is_refused() -> None:
    with pytest.raises(ValueError, match=r"critic_rounds is -1; expected a whole number from 1 to"):
        critic_first(-1)
