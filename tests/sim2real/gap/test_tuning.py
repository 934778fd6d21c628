"""Which arms learn and where, several at once; what one that fails leaves to the others."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path
from subprocess import CompletedProcess

import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from puckpilot import main
from sim2real.gap import tuning
from sim2real.gap.circle_folder import CircleFolder
from sim2real.gap.tuning import fine_tune, untrained
from tests.places import ROOT
from tests.sim2real.gap.test_stages import CONDITIONS

ARMS = ["allowing", "unchanged", "randomized", "truth"]


@pytest.fixture
def folder(tmp_path: Path) -> CircleFolder:
    return CircleFolder(tmp_path / "late", replace(CONDITIONS, minutes=2.0), tmp_path / "shared")


@pytest.fixture
def commands(monkeypatch: pytest.MonkeyPatch) -> list[list[str]]:
    """What would be run: that of the truth fails."""
    given: list[list[str]] = []

    def run(words: list[str], **_: object) -> CompletedProcess[str]:
        given.append(words)
        return CompletedProcess(words, int("truth" in " ".join(words)))

    monkeypatch.setattr(tuning.subprocess, "run", run)
    return given


def test_what_is_the_same_for_every_table_is_learnt_once(folder: CircleFolder, commands: list[list[str]]) -> None:
    assert untrained(folder, ARMS) == ["unchanged", "randomized", "truth"]
    fine_tune(folder, ["unchanged", "randomized"], 2)
    outs = {words[words.index("--out") + 1] for words in commands}
    assert outs == {str(folder.path.parent / "shared" / arm / "training") for arm in ("unchanged", "randomized")}
    assert all(words[words.index("--minutes") + 1] == "2" for words in commands)
    other = replace(folder, path=folder.path.parent / "warp", conditions=replace(folder.conditions, table="warp"))
    assert untrained(other, ARMS) == ["truth"] and other.player("unchanged") == folder.player("unchanged")
    assert untrained(replace(folder, shared=None), ARMS) == ["unchanged", "randomized", "truth"]


def test_a_budget_of_steps_stands_in_place_of_minutes(folder: CircleFolder, commands: list[list[str]]) -> None:
    counted = replace(folder, conditions=replace(folder.conditions, minutes=None, steps=7_000_000))
    fine_tune(counted, ["unchanged"], 1)
    assert commands[0][commands[0].index("--steps") + 1] == "7000000" and "--minutes" not in commands[0]


def test_an_arm_that_fails_leaves_the_others(folder: CircleFolder, commands: list[list[str]]) -> None:
    with pytest.raises(ValueError, match=r"puckpilot train --out .* failed, as .*truth.training\.log says$"):
        fine_tune(folder, ["truth", "unchanged"], 1)
    assert untrained(folder, ARMS) == ["randomized", "truth"] and len(commands) == 2


def test_a_run_goes_on_for_what_is_left(folder: CircleFolder, commands: list[list[str]]) -> None:
    run = folder.trained("unchanged").parent / "training"
    run.mkdir(parents=True)
    (run / "checkpoint.pt").touch()
    (run / "curve.csv").write_text("round,seconds\n1,30.0\n2,90.0\n")
    fine_tune(folder, ["unchanged"], 1)
    (words,) = commands
    assert "--resume" in words and "--start" not in words and words[words.index("--minutes") + 1] == "0.5"


def test_fewer_steps_than_the_preset_needs_to_teach_the_player_are_refused() -> None:
    preset = tomllib.loads((ROOT / "agents" / "presets" / f"{tuning.PRESET}.toml").read_text())
    round_steps = preset["round"] * preset["steps"] * preset["tables"]
    assert (preset["critic_rounds"] + 1) * round_steps == tuning.FEWEST_STEPS


def test_training_without_its_packages_is_refused_in_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setattr(tuning.importlib.util, "find_spec", lambda name: None)
    assert main(["gap", "--arms", "truth", "--out", str(tmp_path / "out")]) == 2
    assert "needs rsl_rl; install it with: pip install 'puckpilot[train]'" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
