"""A run that begins with what another has learned, and is shown more than that was."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch
from tiny import training

from agents.policy import PolicyPlayer, load_policy
from agents.widen import FIRST, widened
from baselines.player import Seat
from puckpilot_env.tables import Tables

SEEN, MORE = "puckpilot/match-v0", "puckpilot/match-randomized-v0"


def test_inputs_go_by_their_names_and_new_ones_move_nothing() -> None:
    """Outputs by hand: columns a and b, then what only a critic sees; c is new, and b comes first now."""
    old = {FIRST: torch.tensor([[1.0, 2.0, 7.0], [3.0, 4.0, 8.0]]), "mlp.0.bias": torch.tensor([0.5, -0.5])}
    new = widened(old, ["a", "b"], ["b", "c", "a"], 4)
    assert new[FIRST].tolist() == [[2.0, 0.0, 1.0, 7.0], [4.0, 0.0, 3.0, 8.0]]
    wider = widened(old, ["a", "b"], ["a", "b", "c"], 6)  # the critic sees two more
    assert wider[FIRST].tolist() == [[1.0, 2.0, 0.0, 7.0, 0.0, 0.0], [3.0, 4.0, 0.0, 8.0, 0.0, 0.0]]
    with pytest.raises(ValueError, match="has 1 inputs beside its columns; expected 0 at most"):
        widened(old, ["a", "b"], ["a", "b"], 2)
    assert new["mlp.0.bias"] is old["mlp.0.bias"] and old[FIRST].shape == (2, 3)


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run after a round in a variant that shows less."""
    path = tmp_path_factory.mktemp("first") / "run"
    training(path, variant=SEEN).round()
    return path


def test_what_was_learned_is_played_on_and_learned_on(first: Path, tmp_path: Path) -> None:
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


def test_a_variant_that_shows_less_is_refused(first: Path, tmp_path: Path) -> None:
    training(tmp_path / "more", variant=MORE, start=first).round()
    with pytest.raises(ValueError, match="reads seen, gantry_c5_x") as error:
        training(tmp_path / "less", variant=SEEN, start=tmp_path / "more")
    assert "\n" not in str(error.value)


def test_a_folder_without_a_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no checkpoint at"):
        training(tmp_path / "new", start=tmp_path / "nothing")
