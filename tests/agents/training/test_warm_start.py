"""Runs that start with the weights of another run or a policy, for other observations or wider layers."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
import torch

from agents.policy.policy import PolicyPlayer, load_policy
from agents.training.preset import Preset, read_preset
from agents.training.warm_start import FIRST_LAYER, remap_inputs, widen_layers
from baselines.player import Seat
from puckpilot_env.tables import Tables
from tests.agents.training.tiny import TINY, training

FEWER, MORE = "puckpilot/match-v0", "puckpilot/match-randomized-v0"


def test_inputs_are_matched_by_name_and_new_ones_have_no_effect() -> None:
    """By hand: columns a and b, then an input of the critic alone; c is new, and b comes first now."""
    old = {FIRST_LAYER: torch.tensor([[1.0, 2.0, 7.0], [3.0, 4.0, 8.0]]), "mlp.0.bias": torch.tensor([0.5, -0.5])}
    new = remap_inputs(old, ["a", "b"], ["b", "c", "a"], 4)
    assert new[FIRST_LAYER].tolist() == [[2.0, 0.0, 1.0, 7.0], [4.0, 0.0, 3.0, 8.0]]
    wider = remap_inputs(old, ["a", "b"], ["a", "b", "c"], 6)  # the critic sees two more
    assert wider[FIRST_LAYER].tolist() == [[1.0, 2.0, 0.0, 7.0, 0.0, 0.0], [3.0, 4.0, 0.0, 8.0, 0.0, 0.0]]
    less = remap_inputs(old, ["a", "b"], ["b"], 2)
    assert less[FIRST_LAYER].tolist() == [[2.0, 7.0], [4.0, 8.0]]
    with pytest.raises(ValueError, match="has 1 inputs beside its columns; expected 0 at most"):
        remap_inputs(old, ["a", "b"], ["a", "b"], 2)
    assert new["mlp.0.bias"] is old["mlp.0.bias"] and old[FIRST_LAYER].shape == (2, 3)


def test_new_units_have_no_effect_at_first() -> None:
    """A network of one hidden unit, by hand: 2 relu(x + 1) + 3; the two new units read x, and no unit reads them."""
    old = {"a": torch.tensor([[1.0]]), "b": torch.tensor([1.0]), "c": torch.tensor([[2.0]]), "d": torch.tensor([3.0])}
    fresh = {"a": torch.full((3, 1), 7.0), "b": torch.full((3,), 7.0), "c": torch.full((2, 3), 7.0), "d": torch.ones(2)}
    new = widen_layers(old, fresh)
    assert new["a"].tolist() == [[1.0], [7.0], [7.0]] and new["b"].tolist() == [1.0, 7.0, 7.0]
    assert new["c"].tolist() == [[2.0, 0.0, 0.0], [7.0, 7.0, 7.0]] and new["d"].tolist() == [3.0, 1.0]
    with pytest.raises(ValueError, match=r"has a layer of \(3, 1\); the preset's has \(1, 1\)"):
        widen_layers(fresh, old)


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run after a round, in a variant with fewer columns."""
    path = tmp_path_factory.mktemp("first") / "run"
    training(path, variant=FEWER).round()
    return path


def test_a_warm_start_plays_as_before_and_learns_on(first: Path, tmp_path: Path) -> None:
    second = training(tmp_path / "second", variant=MORE, start=first)
    tables = Tables(MORE, 4, seed=3)
    seat = Seat.from_tables(tables)
    observation = np.ascontiguousarray(tables.observations[:, 0])
    before, begun = (
        load_policy(path) for path in (first / "policy.npz", tmp_path / "second" / "selves" / "self-0.npz")
    )
    assert len(begun.columns) > len(before.columns)
    acts = [PolicyPlayer(policy, seat).act(observation) for policy in (before, begun)]
    assert np.ptp(acts[0], axis=0).max() > 0.0
    np.testing.assert_array_equal(acts[0], acts[1])
    assert second.steps == 0
    second.round()
    after = PolicyPlayer(second.policy(), seat).act(observation)
    assert not np.array_equal(after, acts[0])


def test_a_variant_with_fewer_columns_is_played_as_the_policy_plays_it(first: Path, tmp_path: Path) -> None:
    training(tmp_path / "more", variant=MORE, start=first).round()
    training(tmp_path / "less", variant=FEWER, start=tmp_path / "more")
    assert_acts_alike(tmp_path / "more" / "policy.npz", tmp_path / "less" / "selves" / "self-0.npz", FEWER)


def test_a_policy_file_is_enough_to_start_with(first: Path, tmp_path: Path) -> None:
    """It plays as the policy does, and explores as a new network does: the file does not hold that."""
    begun = training(tmp_path / "run", variant=MORE, start=first / "policy.npz", preset=named("init_scale = 0.3"))
    assert_acts_alike(first / "policy.npz", tmp_path / "run" / "selves" / "self-0.npz", MORE)
    seen = begun.env.get_observations()
    begun.runner.alg.actor(seen, stochastic_output=True)
    scale = begun.runner.alg.actor.output_std.detach()
    assert float(scale.min()) > 0.25 and float(scale.max()) < 0.35
    begun.round()
    with pytest.raises(ValueError, match=r"policy.npz has a layer of \(16, 28\); the preset's has \(12, 28\)$"):
        training(tmp_path / "thin", variant=MORE, start=first / "policy.npz", preset=named("hidden = [12]"))
    with pytest.raises(ValueError, match=r"has 2 layers; the preset's network has 3$"):
        training(tmp_path / "deep", variant=MORE, start=first / "policy.npz", preset=named("hidden = [16, 16]"))


def test_a_wider_network_starts_as_the_narrower_one_plays(first: Path, tmp_path: Path) -> None:
    for number, start in enumerate((first, first / "policy.npz")):
        begun = training(tmp_path / f"{number}", variant=FEWER, start=start, preset=named("hidden = [24]"))
        assert_acts_alike(first / "policy.npz", tmp_path / f"{number}" / "selves" / "self-0.npz", FEWER)
        assert begun.policy().network.sizes[1] == 24
        begun.round()


def test_a_policy_with_another_scaling_is_refused(first: Path, tmp_path: Path) -> None:
    policy = load_policy(first / "policy.npz")
    policy.scaling.span[2] *= 2.0
    policy.save(tmp_path / "other.npz")
    run = tmp_path / "other"
    shutil.copytree(first, run)
    policy.save(run / "policy.npz")
    for start in (tmp_path / "other.npz", run):
        with pytest.raises(ValueError, match="reads its columns in other units"):
            training(tmp_path / "run", variant=FEWER, start=start)


def named(line: str) -> Preset:
    """The tiny preset with a line of its network."""
    return read_preset(TINY.replace("hidden = [16]", line if "hidden" in line else f"hidden = [16]\n{line}"), "named")


def assert_acts_alike(one: Path, other: Path, variant: str) -> None:
    """Both policies play the same actions at the variant."""
    tables = Tables(variant, 4, seed=3)
    observation = np.ascontiguousarray(tables.observations[:, 0])
    players = [PolicyPlayer(load_policy(path), Seat.from_tables(tables)) for path in (one, other)]
    acts = [player.act(observation) for player in players]
    assert np.ptp(acts[0], axis=0).max() > 0.0
    np.testing.assert_array_equal(acts[0], acts[1])


def test_a_folder_without_a_run_is_refused(tmp_path: Path) -> None:
    (tmp_path / "nothing").mkdir()
    with pytest.raises(ValueError, match="no checkpoint at"):
        training(tmp_path / "new", start=tmp_path / "nothing")
