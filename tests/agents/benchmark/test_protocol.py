"""The protocol is frozen: its hash, and that the kept-out player is in no training of this project."""

from __future__ import annotations

from pathlib import Path

import pytest

from agents.benchmark.protocol import FILE, read_protocol
from agents.benchmark.reference_plays import PLAYS
from agents.training.preset import find_preset, preset_names
from puckpilot_env.variants import all_variants

HASH = "0e9ed42cf252e7e1"  # of protocol 1, which entries state; another game needs another version, not another number


def test_protocol_1_is_frozen() -> None:
    assert read_protocol().hash == HASH


def test_every_registered_environment_is_a_task() -> None:
    assert {task.variant for task in read_protocol().tasks.values()} == set(all_variants())


def test_nobody_here_trains_against_the_player_that_is_kept_out() -> None:
    kept_out = read_protocol().kept_out
    for name in preset_names():
        preset = find_preset(name)
        assert kept_out not in preset.anchors and all(kept_out not in extra.anchors for extra in preset.beside)
    assert all(kept_out not in task.opponents for task in read_protocol().tasks.values())


@pytest.mark.parametrize(("old", "new"), [("games = 200 ", "games = 100 "), ('"veteran"]', '"follower"]')])
def test_another_number_or_opponent_is_another_hash(old: str, new: str, tmp_path: Path) -> None:
    text = FILE.read_text(encoding="utf-8")
    assert old in text
    other = tmp_path / "protocol.toml"
    other.write_text(text.replace(old, new, 1), encoding="utf-8")
    assert read_protocol(other).hash != HASH


def test_a_comment_is_no_other_protocol(tmp_path: Path) -> None:
    other = tmp_path / "protocol.toml"
    other.write_text(f"# said otherwise\n{FILE.read_text(encoding='utf-8')}", encoding="utf-8")
    assert read_protocol(other).hash == HASH


def test_tasks_are_found_by_name_or_id_in_the_protocols_order() -> None:
    protocol = read_protocol()
    found = protocol.chosen(["puckpilot/attack-v0", "match-v0"])
    assert [task.name for task in found] == ["match-v0", "attack-v0"] and len(protocol.chosen([])) == 7
    with pytest.raises(ValueError, match=r"'match-v9' is no task of the protocol; expected some of match-v0, "):
        protocol.chosen(["match-v9"])


def test_a_file_without_reference_plays_is_refused(tmp_path: Path) -> None:
    broken = tmp_path / PLAYS.name
    broken.write_bytes(PLAYS.read_bytes()[:1000])
    with pytest.raises(ValueError, match=r"has no reference plays"):
        read_protocol(FILE, broken)
