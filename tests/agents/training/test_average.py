"""A player whose weights are averaged over updates: the mean by hand, and a run that resumes exactly."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from torch import nn

from agents.training.preset import Preset, read_preset
from tests.agents.training.tiny import TINY, training

UPDATES = 4


def averaging() -> Preset:
    return read_preset(f"average = {UPDATES}\n{TINY}", "tiny")


def test_the_player_has_the_moving_average_of_the_weights_after_each_update(tmp_path: Path) -> None:
    run = training(tmp_path, preset=averaging())
    update, weights = run.runner.alg.update, []
    layer = next(one for one in run.runner.alg.get_policy().mlp.modules() if isinstance(one, nn.Linear))

    def noted() -> dict[str, float]:
        losses = update()
        weights.append(layer.weight.detach().numpy().astype(float).copy())
        return losses

    run.runner.alg.update = noted
    for _ in range(3):
        run.round()
    by_hand = weights[0]
    for number, one in enumerate(weights[1:], 2):
        by_hand = by_hand + (one - by_hand) / min(number, UPDATES)
    assert len(weights) == 6 and np.abs(weights[-1] - by_hand).max() > 1e-4  # so it says something
    np.testing.assert_allclose(run.policy().network.weights[0], by_hand, atol=1e-6)


def test_an_averaging_run_that_was_stopped_equals_an_unbroken_one(tmp_path: Path) -> None:
    unbroken = training(tmp_path / "a", preset=averaging())
    for _ in range(3):
        unbroken.round()
    training(tmp_path / "b", preset=averaging()).round()
    resumed = training(tmp_path / "b", preset=averaging(), resume=True)
    for _ in range(2):
        resumed.round()
    for one, other in zip(unbroken.policy().network.weights, resumed.policy().network.weights, strict=True):
        np.testing.assert_array_equal(one, other)
