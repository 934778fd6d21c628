"""Every command that takes a policy takes it by the same names, and says in one line what a wrong one should be."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from types import SimpleNamespace

import pytest

from agents.commands import train
from agents.policy import policy as policy_module
from agents.policy.policy import PolicyPlayer, find_policy, is_policy, policy_file
from baselines import find_player, full_name
from baselines.player import Seat
from puckpilot import main
from puckpilot_env.tables import Tables
from tests.agents.policy.some_policy import made

SPELLINGS = ["policy:ours", "ours", "policy:run/policy.npz", "run/policy.npz", "policy:run", "run", "./run/"]
WRONG = {
    "policy:nobody": "no policy 'nobody'; expected 'ours', a policy's .npz file, or the folder of a training run",
    "policy:": "no policy ''; expected 'ours', ",
    "no/such/file.npz": "no policy 'no/such/file.npz'; expected 'ours', ",
    "policy:no/such/run": "no policy 'no/such/run'; expected 'ours', ",
    "empty": "no policy in the folder 'empty': it has no policy.npz; expected the folder of a training run, which",
    "policy:empty": "no policy in the folder 'empty': it has no policy.npz; expected the folder of a training run",
    "broken.npz": "broken.npz is not a policy, or is truncated (BadZipFile); expected an .npz file that `puckpilot",
    "broken": "broken/policy.npz is not a policy, or is truncated (BadZipFile); expected an .npz file",
}


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A place with a shipped policy `ours`, the same in a run's folder, an empty folder, and broken files."""
    (tmp_path / "shipped").mkdir()
    for folder in ("run", "empty", "broken"):
        (tmp_path / "here" / folder).mkdir(parents=True)
    made(seed=9).save(tmp_path / "shipped" / "ours.npz")
    shutil.copy(tmp_path / "shipped" / "ours.npz", tmp_path / "here" / "run" / "policy.npz")
    for file in ("broken.npz", "broken/policy.npz"):
        (tmp_path / "here" / file).write_bytes(b"no policy")
    monkeypatch.setattr(policy_module, "SHIPPED", tmp_path / "shipped")
    monkeypatch.chdir(tmp_path / "here")
    return tmp_path / "here"


class Begun(Exception):  # noqa: N818 - it is no error
    """Training has begun; as far as a test of names goes."""


def words_of(command: str, name: str) -> list[str]:
    """The command with this policy, as short as may be."""
    short = ["--games", "2", "--json"]
    return {
        "match": ["match", name, "still", "--variant", "defence-v0", *short],
        "evaluate": ["evaluate", name, "--against", "still", "--variants", "drills", "--hampered", "still", *short],
        "exploit": ["exploit", name, "--steps", "1", "--out", "response"],
        "export": ["export", name, "--out", "exported.npz"],
    }[command]


def refused(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    assert main(words) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.count("\n") == 1
    return said.err


@pytest.mark.parametrize("name", SPELLINGS)
def test_one_policy_is_found_by_all_its_names(name: str) -> None:
    assert is_policy(name) and find_policy(name).about["seed"] == 9
    player = find_player(name)(Seat.from_tables(Tables("defence-v0", 1)))
    assert isinstance(player, PolicyPlayer) and player.policy.about["seed"] == 9
    assert full_name(name) == f"policy:{name.removeprefix('policy:')}"


# An evaluation takes seconds, so that most of its spellings are left to a long run.
SPELT = [
    pytest.param(command, name, marks=pytest.mark.long if command == "evaluate" and name != "run" else ())
    for command in ("match", "evaluate", "exploit", "export")
    for name in SPELLINGS
]


@pytest.mark.slow
@pytest.mark.parametrize(("command", "name"), SPELT)
def test_every_command_accepts_every_spelling(
    command: str, name: str, here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    trained_against = []

    def begin(folder: object, settings: SimpleNamespace, **options: object) -> None:
        trained_against.append(settings.against)
        raise Begun

    monkeypatch.setattr(train, "run_training", begin)  # what exploit finds of the policy is what training gets
    full = f"policy:{name.removeprefix('policy:')}"
    if command == "exploit":
        with pytest.raises(Begun):
            main(words_of(command, name))
        assert trained_against == [full]
        return
    assert main(words_of(command, name)) == 0
    printed = capsys.readouterr().out
    if command == "export":
        assert find_policy("exported.npz").about["seed"] == 9
    else:
        found = json.loads(printed)
        assert (found["players"][0] == name) if command == "match" else (found["player"] == full)


@pytest.mark.parametrize("name", WRONG)
@pytest.mark.parametrize("command", ["match", "evaluate", "exploit", "export"])
def test_every_command_refuses_wrong_policies_in_one_line(
    command: str, name: str, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = sorted(here.rglob("*"))
    assert refused(capsys, *words_of(command, name)).startswith(f"puckpilot {command}: {WRONG[name]}")
    assert sorted(here.rglob("*")) == before


@pytest.mark.parametrize("command", ["match", "evaluate", "exploit"])
def test_an_unknown_player_gets_the_nearest_name_suggested(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert "unknown player 'oures'; did you mean 'ours'?" in refused(capsys, *words_of(command, "oures"))
    said = refused(capsys, *words_of(command, "xyzzy"))
    assert "unknown player 'xyzzy'; known: bank_shot, " in said and "ours, a policy's .npz file, a run's folder" in said
    assert "unknown player ''" in refused(capsys, *words_of(command, ""))


def test_a_script_s_name_is_the_script_whatever_lies_here(here: Path) -> None:
    shutil.copytree(here / "run", here / "goalie")
    assert full_name("goalie") == "goalie" and getattr(find_player("goalie"), "__name__", "") == "Goalie"
    assert full_name("policy:goalie") == "policy:goalie" and find_policy("goalie").about["seed"] == 9


def test_a_shipped_name_is_the_shipped_policy_whatever_lies_here(here: Path) -> None:
    (here / "ours").mkdir()
    made(seed=3).save(here / "ours" / "policy.npz")
    assert find_policy("ours").about["seed"] == 9 and find_policy("./ours").about["seed"] == 3


def test_a_variant_may_have_its_own_policy_file(here: Path) -> None:
    made(seed=3).save(here / "run" / "policy.attack-v0.npz")
    made(seed=4).save(here.parent / "shipped" / "ours.attack-v0.npz")
    for name, seed in (("run", 3), ("run/policy.npz", 3), ("ours", 4)):
        for variant, expected in (("attack-v0", seed), ("puckpilot/attack-v0", seed), ("defence-v0", 9)):
            player = find_player(name)(Seat.from_tables(Tables(variant, 1)))
            assert isinstance(player, PolicyPlayer) and player.policy.about["seed"] == expected
    assert policy_module.policy_names() == ["ours"]


def test_shipped_policies_are_listed(tmp_path: Path) -> None:
    assert policy_module.policy_names() == ["ours"]
    assert policy_file("policy:ours") == tmp_path / "shipped" / "ours.npz"
