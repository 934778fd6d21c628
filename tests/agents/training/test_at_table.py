"""Learning with what is true of every physical table: at the robot's seat alone, against every opponent's hand."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from agents.training.run import Training
from agents.training.run_folder import RunFolder
from agents.training.settings import Settings
from puckpilot import main
from puckpilot_env.options.at_table import AT_TABLE
from tests.agents.training.tiny import TINY, tiny


def made(path: Path, effects: dict[str, float], **changed: object) -> Training:
    settings = Settings("puckpilot/match-v0", 5, 1, tiny(**changed), effects=effects)
    folder = RunFolder(path)
    folder.begin(settings.as_dict())
    return Training(folder, settings)


def test_the_learner_plays_the_robot_at_every_table_and_never_itself(tmp_path: Path) -> None:
    run = made(tmp_path, dict(AT_TABLE))
    (env,) = run.env.envs
    assert env.matchmaking.learner_rows.tolist() == list(range(0, 24, 2))
    assert [(block.first, block.last) for block in env.matchmaking.blocks] == [(0, 2), (2, 4), (4, 6), (6, 12)]
    assert (env.tables.params["hand"] == 1.0).all()
    run.round()
    assert bool(env.get_observations()["policy"].isfinite().all())


def test_only_physics_that_may_lean_turns_the_mirror_symmetry_off(tmp_path: Path) -> None:
    assert made(tmp_path / "a", {**AT_TABLE, "friction": 0.1}).preset.flip == "rows"
    assert made(tmp_path / "b", {**AT_TABLE, "tilt_y": 0.1}).preset.flip == "none"


def test_without_opponents_there_is_nobody_to_have_the_hand(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    none = TINY.replace("anchors = { still = 2, random = 2 }", "anchors = {}").replace("[2, 2]", "[]")
    (tmp_path / "none.toml").write_text(none)
    assert main(["train", "--out", str(tmp_path / "run"), "--preset", str(tmp_path / "none.toml"), "--at-table"]) == 2
    assert "a table with a hand has no self-play; expected a preset with" in capsys.readouterr().err


def test_effects_beside_the_option_are_kept_and_may_not_contradict_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    head = 'format = "puckpilot-effects/1"\n[parameters]\n'
    for name, row in (("tilt", "tilt_y = 0.1"), ("slow", "braking_time = 0.1")):
        (tmp_path / f"{name}.toml").write_text(head + row + "\n")
    (tmp_path / "tiny.toml").write_text(TINY)
    words = ["train", "--preset", str(tmp_path / "tiny.toml"), "--steps", "1", "--out", str(tmp_path / "run")]
    tilt, slow = ["--effects", str(tmp_path / "tilt.toml")], ["--effects", str(tmp_path / "slow.toml")]
    assert main([*words, "--at-table", *slow]) == 2
    assert "--effects gives another braking_time than --at-table" in capsys.readouterr().err
    assert main([*words, "--at-table", *tilt]) == 0
    assert json.loads((tmp_path / "run" / "run.json").read_text())["effects"] == {**AT_TABLE, "tilt_y": 0.1}
    assert main([*words, "--resume", "--at-table", *tilt]) == 0 and main([*words, "--resume", *slow]) == 2


def test_the_option_is_kept_and_resumed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "tiny.toml").write_text(TINY)
    words = ["train", "--preset", str(tmp_path / "tiny.toml"), "--steps", "1", "--out", str(tmp_path / "run")]
    assert main([*words, "--at-table"]) == 0
    assert json.loads((tmp_path / "run" / "run.json").read_text())["effects"] == AT_TABLE
    assert main([*words, "--at-table", "--resume"]) == 0
    other = [*words[:-1], str(tmp_path / "other")]
    assert main(other) == 0 and main([*other, "--resume", "--at-table"]) == 2
    assert f"--at-table is given where the run has another {', '.join(AT_TABLE)};" in capsys.readouterr().err
