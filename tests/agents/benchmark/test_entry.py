"""Entries of the leaderboard: what is written can be read, and what is no entry is refused in one line."""

from __future__ import annotations

from hashlib import sha256
from pathlib import Path

import pytest

from agents.benchmark.entry import copy_policy, read_entry, tasks_claimed, write_entry
from agents.benchmark.evaluation import Against
from agents.benchmark.protocol import read_protocol
from tests.agents.policy.some_policy import made

PROTOCOL = read_protocol()
ROWS = [Against(one, 200, 70, 20, (50, 10), False) for one in PROTOCOL.evaluated_against(PROTOCOL.tasks["attack-v0"])]


@pytest.fixture
def entry_path(tmp_path: Path) -> Path:
    player = made().save(tmp_path / "mine.npz")
    made("attack-v0", seed=2).save(tmp_path / "mine.attack-v0.npz")
    contents = copy_policy(str(player), "ours", [PROTOCOL.tasks["attack-v0"]], tmp_path)
    return write_entry("ours", 'PPO, "some" steps', PROTOCOL, {"attack-v0": ROWS}, contents, tmp_path / "board")


def test_an_entry_is_read_as_it_was_written(entry_path: Path) -> None:
    entry = read_entry(entry_path)
    assert (entry.name, entry.trained, entry.protocol) == ("ours", 'PPO, "some" steps', PROTOCOL.hash)
    content = {name: (entry_path.parent / name).read_bytes() for name in ("ours.npz", "ours.attack-v0.npz")}
    assert dict(entry.files) == {name: sha256(each).hexdigest() for name, each in content.items()}
    claimed = [(one.opponent, one.games, one.won, one.lost) for one in entry.claims]
    assert claimed == [(row.opponent, 200, 70, 20) for row in ROWS]
    assert [task.name for task in tasks_claimed(entry, PROTOCOL)] == ["attack-v0"]
    assert (entry_path.parent / "ours.npz").read_bytes() == (entry_path.parents[1] / "mine.npz").read_bytes()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("puckpilot-entry/1", "puckpilot-entry/9", "format is 'puckpilot-entry/9'; expected the line"),
        ('name = "ours"', 'name = "../ours"', "name is '../ours'; expected that of the file, ours"),
        ('"ours.npz" =', '"../../ours.npz" =', "expected the SHA-256 of ours.npz or ours.onnx by its name"),
        ('"ours.npz" =', '"other.npz" =', "expected either ours.npz or ours.onnx, the policy"),
        ("won = 70", "won = 190", "a claim is of [200, 190, 20] games, won and lost; expected whole numbers that fit"),
        ("won = 70", "won = 7.5", "a claim is of [200, 7.5, 20] games"),
        ("won = 70", "win = 70", "unknown entry of a claim 'win'; did you mean 'won'?"),
        ("lost = 20", "", "a claim has no lost; expected task, opponent, games, won, lost"),
    ],
)
def test_what_is_no_entry_is_refused_in_one_line(old: str, new: str, said: str, entry_path: Path) -> None:
    text = entry_path.read_text(encoding="utf-8")
    assert old in text
    entry_path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(ValueError) as error:
        read_entry(entry_path)
    assert said in str(error.value) and str(entry_path) in str(error.value) and "\n" not in str(error.value)


def test_an_opponent_that_is_left_out_is_refused(entry_path: Path) -> None:
    entry = read_entry(entry_path)
    some = type(entry)(entry.name, entry.trained, entry.protocol, entry.files, entry.claims[:-1], entry.folder)
    with pytest.raises(ValueError, match=r"attack-v0 is claimed against still, goalie, interceptor; expected .*corner"):
        tasks_claimed(some, PROTOCOL)


def test_a_claim_of_few_games_is_refused(entry_path: Path) -> None:
    text = entry_path.read_text(encoding="utf-8").replace("games = 200", "games = 90", 1)
    entry_path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=r"attack-v0 is claimed of 90 games; expected 200"):
        tasks_claimed(read_entry(entry_path), PROTOCOL)


@pytest.mark.parametrize("alias", ["puckpilot/attack-v0", "x/attack-v0", "Attack-v0"])
def test_a_task_by_another_name_is_refused(alias: str, entry_path: Path) -> None:
    """Else what is claimed of it would be played by no one."""
    text = entry_path.read_text(encoding="utf-8")
    more = text + "".join(text[text.index("\n[[claim]]") :]).replace('"attack-v0"', f'"{alias}"')
    entry_path.write_text(more, encoding="utf-8")
    with pytest.raises(ValueError, match=rf"unknown task '{alias}'; did you mean 'attack-v0'\?"):
        tasks_claimed(read_entry(entry_path), PROTOCOL)


def test_an_entry_that_is_made_anew_leaves_no_file_of_the_one_before(entry_path: Path) -> None:
    (entry_path.parent / "ours2.npz").write_bytes(b"of another")
    write_entry("ours", "", PROTOCOL, {"attack-v0": ROWS}, {"ours.npz": b"new"}, entry_path.parent)
    assert sorted(one.name for one in entry_path.parent.iterdir()) == ["ours.npz", "ours.toml", "ours2.npz"]


@pytest.mark.parametrize(
    ("name", "player", "said"), [("a/b", "champion", "--name is 'a/b'"), ("ours", "nobody", "no policy 'nobody'")]
)
def test_a_name_that_is_none_and_a_player_that_is_no_policy_are_refused(
    name: str, player: str, said: str, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match=said):
        copy_policy(player, name, [], tmp_path)
    assert not list(tmp_path.iterdir())
