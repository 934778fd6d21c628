"""The policy file: what it plays, what is refused in one line, and that reading it runs no code."""

from __future__ import annotations

import io
import json
import pickle
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from agents.policy.policy import PolicyPlayer, load_policy
from baselines.matches.match import play
from baselines.player import Seat
from puckpilot_env.tables import Tables
from tests.agents.policy.hostile import Bomb
from tests.agents.policy.some_policy import made


@pytest.fixture
def saved(tmp_path: Path) -> Path:
    return made().save(tmp_path / "mine.npz")


def contents(path: Path) -> dict[str, Any]:
    with np.load(path) as file:
        return {name: file[name] for name in file.files}


def refusal(path: Path) -> str:
    with pytest.raises(ValueError) as error:
        load_policy(path)
    words = str(error.value)
    assert "\n" not in words and str(path) in words and len(words) < 400
    return words


def test_a_loaded_policy_plays_as_the_saved_one(tmp_path: Path) -> None:
    before = made()
    after = load_policy(before.save(tmp_path / "a.npz"))
    assert (after.columns, after.about) == (before.columns, before.about)
    assert (tmp_path / "a.npz").stat().st_size < 20_000 and len(list(tmp_path.iterdir())) == 1
    tables = Tables("match-v0", 6, seed=4)
    seat = Seat.from_tables(tables)
    players = [PolicyPlayer(policy, seat) for policy in (before, after)]
    for _ in range(5):
        actions = [player.act(tables.observations[:, 0]) for player in players]
        assert (actions[0] == actions[1]).all() and actions[0].dtype == np.float32
        tables.step(np.stack(actions, axis=1))


def test_the_player_plays_the_median_scaled_to_the_action_space() -> None:
    policy, tables = made(), Tables("match-v0", 9, seed=4)
    found = PolicyPlayer(policy, Seat.from_tables(tables)).act(tables.observations[:, 1])
    x = (tables.observations[:, 1].astype(np.float64) - policy.scaling.centre) / policy.scaling.span
    hidden = np.maximum(x @ policy.network.weights[0].astype(np.float64).T + policy.network.biases[0], 0.0)
    outputs = np.tanh(hidden @ policy.network.weights[1].astype(np.float64).T + policy.network.biases[1])
    low, high = tables.action_bounds.astype(np.float64)
    np.testing.assert_allclose(found, low + (outputs + 1.0) / 2.0 * (high - low), atol=1e-4)


@pytest.mark.parametrize("variant", ["match-v0", "match-randomized-v0", "defence-v0"])
def test_a_policy_file_plays_by_its_name(saved: Path, variant: str) -> None:
    result = play(variant, f"policy:{saved}", "still", 4, 1)
    assert sum(result.wins) + result.draws == 4
    assert play(variant, f"policy:{saved}", "still", 4, 1).lengths.tolist() == result.lengths.tolist()


@pytest.mark.parametrize("tenth", range(10))
def test_a_file_cut_short_is_refused(saved: Path, tenth: int) -> None:
    whole = saved.read_bytes()
    saved.write_bytes(whole[: len(whole) * tenth // 10])
    assert "is not a policy, or is truncated" in refusal(saved)


def test_a_file_with_a_flipped_byte_is_refused_or_plays(saved: Path) -> None:
    """The zip's sums catch what is in its members; nothing else than a refusal may come of the rest."""
    whole = saved.read_bytes()
    refused = 0
    for at in range(0, len(whole), 37):
        saved.write_bytes(whole[:at] + bytes([whole[at] ^ 0x55]) + whole[at + 1 :])
        try:
            load_policy(saved)
        except ValueError as error:
            refused += "\n" not in str(error)
    assert refused > 0.5 * len(whole) / 37


def test_no_file_a_folder_and_a_bare_array_are_refused(tmp_path: Path) -> None:
    assert "no policy at" in refusal(tmp_path / "none.npz")
    refusal(tmp_path)
    np.save(tmp_path / "a.npy", np.ones(3))
    refusal(tmp_path / "a.npy")


@pytest.mark.parametrize("form", ["npz", "npy", "bare"])
def test_a_pickle_is_refused_and_does_not_run(tmp_path: Path, form: str) -> None:
    path, mark = tmp_path / "evil.npz", tmp_path / "ran"
    bomb = np.array([Bomb(mark)], dtype=object)
    if form == "npz":
        np.savez(path, allow_pickle=True, head=bomb, weights_0=bomb)
    elif form == "npy":
        with path.open("wb") as file:
            np.save(file, bomb, allow_pickle=True)
    else:
        path.write_bytes(pickle.dumps(Bomb(mark)))
    refusal(path)
    assert not mark.exists()
    if form == "bare":
        pickle.loads(path.read_bytes())
    else:
        loaded = np.load(path, allow_pickle=True)
        _ = loaded["head"] if form == "npz" else loaded
    assert mark.exists()  # it would have run


def test_an_array_that_claims_to_be_vast_is_refused(saved: Path) -> None:
    """A header may say anything; a refusal, not an end of the process, comes of it."""
    text = "{'descr': '<f8', 'fortran_order': False, 'shape': (9000000000000000,), }"
    header = io.BytesIO()
    header.write(b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text.encode())
    with zipfile.ZipFile(saved, "a") as file:
        file.writestr("weights_7.npy", header.getvalue())
    refusal(saved)


def test_a_small_file_that_decompresses_to_a_vast_one_is_refused(saved: Path) -> None:
    with zipfile.ZipFile(saved, "a", zipfile.ZIP_DEFLATED) as file, file.open("weights_9.npy", "w") as member:
        for _ in range(300):
            member.write(bytes(1 << 20))
    assert saved.stat().st_size < 1 << 20
    assert "is not a policy" in refusal(saved)


def test_members_that_are_not_stored_as_numpy_stores_them_are_refused(saved: Path) -> None:
    with zipfile.ZipFile(saved, "a", zipfile.ZIP_DEFLATED) as file:
        file.writestr("weights_9.npy", b"no array")
    refusal(saved)


@pytest.mark.parametrize(
    "head",
    ["[]", "3", "null", "{", "[" * 100_000, "{}"],
    ids=["list", "number", "null", "cut", "deep", "empty"],
)
def test_an_invalid_head_is_refused(saved: Path, head: str) -> None:
    np.savez(saved, **{**contents(saved), "head": np.array(head)})
    refusal(saved)


def test_a_later_format_is_refused(saved: Path) -> None:
    arrays = contents(saved)
    head = {**json.loads(str(arrays.pop("head"))), "format": "puckpilot-policy-99"}
    np.savez(saved, head=np.array(json.dumps(head)), **arrays)
    assert "is not of the format puckpilot-policy-1" in refusal(saved)


BAD: dict[str, Callable[[dict[str, Any]], Any]] = {
    "no weights": lambda c: c.pop("weights_1"),
    "no biases": lambda c: c.pop("biases_0"),
    "no layer": lambda c: [c.pop(name) for name in list(c) if name[:5] in ("weigh", "biase")],
    "a layer too many": lambda c: c.update(weights_5=c["weights_0"]),
    "too wide": lambda c: c.update(weights_0=np.ones((8, 99), np.float32)),
    "too many outputs": lambda c: c.update(weights_1=np.ones((5, 8), np.float32), biases_1=np.ones(5, np.float32)),
    "weights that are a number": lambda c: c.update(weights_0=np.float32(1.0)),
    "weights that are words": lambda c: c.update(weights_0=np.array([["a"] * 21] * 8)),
    "weights that are complex": lambda c: c.update(weights_0=c["weights_0"].astype(np.complex64)),
    "weights not finite": lambda c: c["weights_0"].fill(np.nan),
    "biases of a wrong length": lambda c: c.update(biases_0=np.ones(3, np.float32)),
    "no centre": lambda c: c.pop("centre"),
    "centre of a wrong length": lambda c: c.update(centre=np.ones(3, np.float32)),
    "span of zero": lambda c: c["span"].fill(0.0),
    "span not finite": lambda c: c["span"].fill(np.inf),
    "low that is words": lambda c: c.update(low=np.array(["a"] * 4)),
    "high of a wrong length": lambda c: c.update(high=np.ones(5, np.float32)),
}
HEADS: dict[str, dict[str, Any]] = {
    "no columns": {"columns": None},
    "columns a number": {"columns": 3},
    "columns a text": {"columns": "puck_x"},
    "columns too few": {"columns": ["puck_x"]},
    "about a number": {"about": 3},
}


@pytest.mark.parametrize("wrong", BAD)
def test_inconsistent_arrays_are_refused(saved: Path, wrong: str) -> None:
    arrays = contents(saved)
    BAD[wrong](arrays)
    np.savez(saved, **arrays)
    assert "does not fit together" in refusal(saved)


@pytest.mark.parametrize("wrong", HEADS)
def test_inconsistent_heads_are_refused(saved: Path, wrong: str) -> None:
    arrays = contents(saved)
    head = {**json.loads(str(arrays.pop("head"))), **HEADS[wrong]}
    np.savez(saved, head=np.array(json.dumps(head)), **arrays)
    assert "does not fit together" in refusal(saved)


def test_a_device_is_refused() -> None:
    assert "is not a policy" in refusal(Path("/dev/zero"))


def test_a_failed_save_leaves_the_file_as_it_was(saved: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = saved.read_bytes()

    def full(draft: Path, **arrays: Any) -> None:
        Path(draft).write_bytes(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", full)
    with pytest.raises(OSError, match="No space"):
        made(seed=2).save(saved)
    assert saved.read_bytes() == before and [path.name for path in saved.parent.iterdir()] == [saved.name]
