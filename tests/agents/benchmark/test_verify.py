"""Honest entries hold; false claims, changed files, another protocol, and policies that do harm do not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper, numpy_helper

from agents.benchmark.entry import Claim, Entry, copy_policy, digest, read_entry, write_entry
from agents.benchmark.evaluation import Against
from agents.benchmark.protocol import read_protocol
from agents.benchmark.sandbox import Limits
from agents.benchmark.verify import SIGNIFICANCE, entry_file, overstated, verify
from agents.policy.network import Network
from agents.policy.policy import MOST_BYTES, SHIPPED
from tests.agents.policy.some_policy import made

PROTOCOL = read_protocol()
DRILL = PROTOCOL.tasks["attack-v0"]
GAMES = 100
# Of 200 episodes the champion wins these against still, goalie, interceptor and corner_shot, as
# `puckpilot benchmark enter champion --name champion --trained "as it is" --tasks attack-v0` says
WON = (182, 167, 181, 181)


def _rows(won: tuple[int, ...]) -> list[Against]:
    opponents = PROTOCOL.evaluated_against(DRILL)
    return [Against(one, 200, hits, 0, (0, 0), False) for one, hits in zip(opponents, won, strict=True)]


@pytest.fixture
def champion(tmp_path: Path) -> Entry:
    contents = copy_policy(str(SHIPPED / "champion.npz"), "champion", [DRILL], tmp_path)
    return read_entry(write_entry("champion", "shipped", PROTOCOL, {DRILL.name: _rows(WON)}, contents, tmp_path))


def _failed(entry: Entry, limits: Limits | None = None, games: int = GAMES) -> dict[str, str]:
    """What does not hold, and why."""
    return {one.what: one.words for one in verify(entry, PROTOCOL, games, 99, limits) if not one.holds}


@pytest.mark.slow
def test_an_honest_entry_holds_and_a_false_claim_does_not(champion: Entry) -> None:
    seen: list[str] = []
    findings = verify(champion, PROTOCOL, GAMES, 99, report=lambda one: seen.append(one.what))
    assert all(one.holds for one in findings) and seen == [one.what for one in findings] and len(findings) == 4 + 4
    weak = made(DRILL.variant).save(champion.policy.with_name("champion.attack-v0.npz"))
    false = replace(champion, files={**champion.files, weak.name: digest(weak.read_bytes())})
    failed = _failed(false, games=20)
    assert set(failed) == {f"attack-v0 against {one}" for one in PROTOCOL.evaluated_against(DRILL)}
    assert failed["attack-v0 against goalie"].startswith("claimed 167 won and 0 lost of 200; played ")


def test_an_entry_is_found_by_its_file_and_one_of_the_leaderboard_by_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "leaderboard").mkdir()
    (tmp_path / "leaderboard" / "ours.toml").touch()
    assert entry_file(Path("ours")) == entry_file(Path("ours.toml")) == Path("leaderboard/ours.toml")
    assert entry_file(Path("elsewhere/ours")) == Path("elsewhere/ours.toml")
    (tmp_path / "ours.toml").touch()
    assert entry_file(Path("ours")) == Path("ours.toml")


def _changed(entry: Entry) -> Entry:
    entry.policy.write_bytes(entry.policy.read_bytes() + b"0")
    return entry


def _missing(entry: Entry) -> Entry:
    entry.policy.unlink()
    return entry


def _linked(entry: Entry) -> Entry:
    entry.policy.rename(entry.folder / "elsewhere")
    entry.policy.symlink_to(entry.folder / "elsewhere")
    return entry


def _added(entry: Entry) -> Entry:
    made().save(entry.folder / "champion.defence-v0.npz")
    return entry


@pytest.mark.parametrize(
    ("change", "what", "words"),
    [
        (lambda one: replace(one, protocol="0" * 16), "protocol", f"{'0' * 16}, here is {PROTOCOL.hash}"),
        (_changed, "champion.npz", "is not the file that was entered"),
        (_missing, "champion.npz", "cannot be read: No such file or directory"),
        (_linked, "champion.npz", "champion.npz is a link"),
        (_added, "champion.defence-v0.npz", "is not listed in the entry"),
    ],
)
def test_nothing_is_played_of_another_protocol_or_file(
    change: Callable[[Entry], Entry], what: str, words: str, champion: Entry, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("agents.benchmark.verify.play_in_sandbox", lambda *args: pytest.fail("it was played"))
    failed = _failed(change(champion))
    assert list(failed) == [what] and failed[what].endswith(words)


def test_what_is_played_is_what_was_looked_at(champion: Entry, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file that is exchanged after it was looked at is not played."""
    seen: list[bytes] = []

    def play(policy: Path, *args: object) -> list[Against]:
        made().save(champion.policy)
        seen.append(policy.read_bytes())
        return _rows(WON)

    monkeypatch.setattr("agents.benchmark.verify.play_in_sandbox", play)
    honest = champion.policy.read_bytes()
    assert not _failed(champion) and seen == [honest] and champion.policy.read_bytes() != honest


def test_an_entry_does_not_hold_where_another_game_is_played(champion: Entry, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("agents.benchmark.verify.departures", lambda: ["match-v0: rewards differ"])
    assert _failed(champion) == {"game": "match-v0: rewards differ"}


def _entered(file: Path, save: Callable[[Path], object]) -> Entry:
    save(file)
    claims = [Claim(DRILL.name, one, 200, 100, 0) for one in PROTOCOL.evaluated_against(DRILL)]
    return Entry(file.stem, "", PROTOCOL.hash, {file.name: digest(file.read_bytes())}, claims, file.parent)


def _large(file: Path) -> Path:
    """A policy of eight layers of 2048: 115 MB, and as many multiplications for each decision."""
    policy, rng = made(DRILL.variant), np.random.default_rng(0)
    sizes = [policy.network.sizes[0], *[2048] * 8, 4]
    weights = [rng.normal(0.0, 0.01, (b, a)).astype(np.float32) for a, b in pairwise(sizes)]
    network = Network(weights, [np.zeros(size, np.float32) for size in sizes[1:]])
    return replace(policy, network=network).save(file)


@pytest.mark.slow
def test_a_policy_that_hangs_is_ended(tmp_path: Path) -> None:
    failed = _failed(_entered(tmp_path / "slow.npz", _large), Limits(seconds=8.0), games=10_000)
    assert failed == {"attack-v0": "did not end within 8 s"}


@pytest.mark.slow
def test_a_policy_that_floods_memory_is_ended(tmp_path: Path) -> None:
    entry = _entered(tmp_path / "large.npz", _large)
    most = 700 << 20  # of which Python and the simulator take half
    assert list(_failed(entry, Limits(memory=most))) == ["attack-v0"]
    small = _entered(tmp_path / "small.npz", made(DRILL.variant).save)
    played = [one.what for one in verify(small, PROTOCOL, 2, 99, Limits(memory=most)) if "against" in one.what]
    assert len(played) == 4  # so it is the policy that took too much


@pytest.mark.slow
def test_a_file_that_unfolds_to_more_than_a_policy_may_have_is_refused(tmp_path: Path) -> None:
    def bomb(file: Path) -> None:
        np.savez_compressed(file, head=np.array("{}"), weights_0=np.zeros(MOST_BYTES // 4, np.float32))

    failed = _failed(_entered(tmp_path / "bomb.npz", bomb))
    assert failed["attack-v0"].startswith("cannot play: ") and "truncated (ValueError)" in failed["attack-v0"]
    assert (tmp_path / "bomb.npz").stat().st_size < 1 << 20


def _looping(file: Path) -> None:
    """An ONNX model that goes round for ever before it acts."""
    inside = helper.make_graph(
        [helper.make_node("Identity", [one], [f"{one}_out"]) for one in ("going", "kept")],
        "inside",
        [helper.make_tensor_value_info(name, kind, shape) for name, kind, shape in
         (("round", TensorProto.INT64, []), ("going", TensorProto.BOOL, []), ("kept", TensorProto.FLOAT, ["n", 4]))],
        [helper.make_tensor_value_info("going_out", TensorProto.BOOL, []),
         helper.make_tensor_value_info("kept_out", TensorProto.FLOAT, ["n", 4])],
    )  # fmt: skip
    weights = np.zeros((17, 4), np.float32)
    constants = {"w": weights, "rounds": np.array(1 << 62), "true": np.array(True)}
    nodes = [
        helper.make_node("MatMul", ["seen", "w"], ["first"]),
        helper.make_node("Loop", ["rounds", "true", "first"], ["action"], body=inside),
    ]
    _save(file, nodes, constants)


def _flooding(file: Path) -> None:
    """An ONNX model of a few bytes that wants 16 GB."""
    constants = {"w": np.zeros((17, 4), np.float32), "size": np.array([1 << 32]), "axis": np.array([0])}
    nodes = [
        helper.make_node("ConstantOfShape", ["size"], ["all"]),
        helper.make_node("ReduceSum", ["all", "axis"], ["sum"]),
        helper.make_node("MatMul", ["seen", "w"], ["first"]),
        helper.make_node("Add", ["first", "sum"], ["action"]),
    ]
    _save(file, nodes, constants)


def _save(file: Path, nodes: list[onnx.NodeProto], constants: dict[str, np.ndarray]) -> None:
    ends = [helper.make_tensor_value_info(name, TensorProto.FLOAT, ["n", size])
            for name, size in (("seen", 17), ("action", 4))]  # fmt: skip
    held = [numpy_helper.from_array(array, name) for name, array in constants.items()]
    graph = helper.make_graph(nodes, "g", ends[:1], ends[1:], held)
    onnx.save(helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8), str(file))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("save", "limits", "said"),
    [
        (_looping, Limits(seconds=8.0), "did not end within 8 s"),
        (_flooding, Limits(), "needs more memory than it may have"),
    ],
)
def test_an_onnx_model_that_hangs_or_floods_memory_is_ended(
    save: Callable[[Path], None], limits: Limits, said: str, tmp_path: Path
) -> None:
    assert _failed(_entered(tmp_path / "model.onnx", save), limits, games=4) == {"attack-v0": said}


def test_a_claim_is_refuted_where_it_is_more_than_chance_gives() -> None:
    level = SIGNIFICANCE / 8
    assert not overstated((180, 200), (170, 200), False, level)
    assert overstated((180, 200), (140, 200), False, level)
    assert not overstated((140, 200), (180, 200), False, level)  # who claims less than is reached is honest
    assert overstated((160, 200), (120, 200), False, level) and not overstated((160, 200), (120, 200), True, level)


@pytest.mark.parametrize("paired", [False, True])
def test_honest_claims_are_seldom_refused(paired: bool) -> None:
    """Drawn anew 4,000 times, in the worst case games of a pair always alike, at a level at which some are refused: not
    more than that."""
    rng, level, alike = np.random.default_rng(5), 0.02, 2 if paired else 1
    drawn = alike * rng.binomial(200 // alike, rng.uniform(0.05, 0.95, (4000, 1)), (4000, 2))
    refused = sum(overstated((int(a), 200), (int(b), 200), paired, level) for a, b in drawn)
    assert 0 < refused <= level * 4000
