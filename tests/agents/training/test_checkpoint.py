"""The checkpoint file: what it restores, what is refused in one line, and that reading it runs no code."""

from __future__ import annotations

import pickle
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from agents.training.checkpoint import load_checkpoint, restore_tables, save_checkpoint, tables_as_tensors
from puckpilot_env.tables import Tables
from tests.agents.policy.hostile import Bomb
from tests.agents.policy.mirrored_tables import random_actions
from tests.agents.training.tiny import files, tiny, training


def refusal(path: Path) -> str:
    with pytest.raises(ValueError) as error:
        load_checkpoint(path)
    words = str(error.value)
    assert "\n" not in words and str(path) in words and len(words) < 400
    return words


@pytest.fixture(scope="module")
def begun(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run after its first round."""
    path = tmp_path_factory.mktemp("runs") / "run"
    training(path).round()
    return path


@pytest.fixture
def run(begun: Path, tmp_path: Path) -> Path:
    """A copy of it."""
    return Path(shutil.copytree(begun, tmp_path / "run"))


def refuse_to_go_on(run: Path, **options: Any) -> str:
    before = files(run)
    with pytest.raises(ValueError) as error:
        training(run, resume=True, **options)
    assert files(run) == before
    assert "\n" not in str(error.value) and len(str(error.value)) < 400
    return str(error.value)


def test_a_checkpoint_loads_what_was_saved(tmp_path: Path) -> None:
    kept = {"numbers": torch.arange(5.0), "word": "ab", "list": [1, {"a": 2.5}], "none": None}
    found = load_checkpoint(save_checkpoint(tmp_path / "c.pt", kept))
    assert found.keys() == kept.keys() and (found["numbers"] == kept["numbers"]).all()
    assert (found["word"], found["list"], found["none"]) == ("ab", [1, {"a": 2.5}], None)


@pytest.mark.parametrize("variant", ["match-v0", "match-randomized-v0"])
def test_restored_tables_continue_exactly(variant: str, tmp_path: Path) -> None:
    tables, restored = Tables(variant, 5, seed=1), Tables(variant, 5, seed=2)
    actions = [random_actions(tables, np.random.default_rng(seed)) for seed in range(60)]
    for one in actions[:20]:
        tables.step(one)
    kept = load_checkpoint(save_checkpoint(tmp_path / "c.pt", {"tables": tables_as_tensors(tables)}))["tables"]
    restore_tables(restored, kept)
    assert (restored.observations == tables.observations).all()
    for one in actions:
        tables.step(one)
        restored.step(one)
        assert (restored.observations == tables.observations).all() and (restored.rewards == tables.rewards).all()


@pytest.mark.parametrize("tenth", range(10))
def test_a_file_cut_short_is_refused(run: Path, tenth: int, tmp_path: Path) -> None:
    path = run / "checkpoint.pt"
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) * tenth // 10])
    assert "is not a checkpoint, or is truncated" in refusal(path)
    if tenth == 5:
        assert "is not a checkpoint, or is truncated" in refuse_to_go_on(run)


@pytest.mark.parametrize("form", ["torch", "old torch", "bare"])
def test_a_pickle_is_refused_and_does_not_run(run: Path, tmp_path: Path, form: str) -> None:
    path, mark = run / "checkpoint.pt", tmp_path / "ran"
    if form == "bare":
        path.write_bytes(pickle.dumps(Bomb(mark)))
    else:
        new = form == "torch"
        torch.save({"format": "puckpilot-checkpoint-1", "rows": Bomb(mark)}, path, _use_new_zipfile_serialization=new)
    refusal(path)
    refuse_to_go_on(run)
    assert not mark.exists()
    if form == "bare":
        pickle.loads(path.read_bytes())
    else:
        torch.load(path, weights_only=False)
    assert mark.exists()  # it would have run


@pytest.mark.parametrize("content", [b"", b"no checkpoint\n", b"PK\x03\x04", bytes(1000), b"\x80\x02.", b"\x80\x02}."])
def test_bytes_of_another_kind_are_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "c.pt").write_bytes(content)
    refusal(tmp_path / "c.pt")


def test_no_file_a_folder_and_another_format_are_refused(tmp_path: Path) -> None:
    assert "no checkpoint at" in refusal(tmp_path / "none.pt")
    refusal(tmp_path)
    for number, content in enumerate(({"format": "puckpilot-checkpoint-9"}, {"a": 1}, [1, 2], torch.zeros(3))):
        torch.save(content, tmp_path / f"{number}.pt")
        assert "is not of the format" in refusal(tmp_path / f"{number}.pt")


def test_a_file_with_a_flipped_byte_is_refused_or_loads(run: Path) -> None:
    path = run / "checkpoint.pt"
    whole = path.read_bytes()
    for at in range(0, len(whole), len(whole) // 60):
        path.write_bytes(whole[:at] + bytes([whole[at] ^ 0x55]) + whole[at + 1 :])
        try:
            load_checkpoint(path)
        except ValueError as error:
            assert "\n" not in str(error)


@pytest.mark.parametrize("other", ["tables", "network", "variant"])
def test_a_checkpoint_of_another_run_is_refused(run: Path, other: str) -> None:
    """Of more tables, of a wider network, or of a variant whose observation is wider."""
    preset = {"tables": tiny(tables=13), "network": tiny(hidden=[17])}.get(other, tiny())
    variant = "puckpilot/match-randomized-v0" if other == "variant" else "puckpilot/match-v0"
    assert "checkpoint" in refuse_to_go_on(run, preset=preset, variant=variant)


def test_a_checkpoint_of_a_variant_that_looks_alike_is_refused(tmp_path: Path) -> None:
    """Attack and defence have tables and observations of the same size."""
    training(tmp_path, variant="puckpilot/defence-v0").round()
    with pytest.raises(ValueError, match=r"is of puckpilot/defence-v0; this run plays puckpilot/attack-v0"):
        training(tmp_path, resume=True, variant="puckpilot/attack-v0")


@pytest.mark.parametrize(
    "part", ["learner", "torch_random", "random", "tables", "rows", "waited", "anchors", "earlier"]
)
def test_a_checkpoint_that_lacks_a_part_is_refused(run: Path, part: str) -> None:
    kept = load_checkpoint(run / "checkpoint.pt")
    save_checkpoint(run / "checkpoint.pt", {name: value for name, value in kept.items() if name != part})
    assert "checkpoint" in refuse_to_go_on(run)


def test_a_missing_snapshot_is_named(run: Path) -> None:
    (run / "selves" / "self-0.npz").unlink()
    assert "self-0.npz" in refuse_to_go_on(run)
