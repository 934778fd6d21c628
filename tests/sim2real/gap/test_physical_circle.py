"""A circle at a physical table: a person at the other end, and no truth is known. A twin stands in for it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from puckpilot import main
from puckpilot_env import Tables
from puckpilot_env.options.at_table import AT_TABLE
from puckpilot_env.options.effects_file import as_content
from puckpilot_env.variants import Variant
from sim2real.gap import stages
from sim2real.gap.arms import ARMS, simulator_of
from sim2real.gap.circle import Circle
from sim2real.gap.circle_folder import CircleFolder, Conditions
from sim2real.gap.gap_table import find_gap_table
from sim2real.gap.overview import overview
from sim2real.table import meetings
from sim2real.table.game.robot_seat import RobotSeat, make_robot_seat
from tests.sim2real.gap.test_against_truth import SILENT_DRAWS, SILENT_EFFECTS, finding

SIZES = {"length": 2.362, "width": 1.144}
FILE = """
format = "puckpilot-table/1"
[parameters]
friction = 0.1
length = 2.362
width = 1.144
[camera]
source = "device:0"
calibration = "table.json"
[board]
port = "/dev/ttyUSB0"
supply = 20.0
"""


@pytest.fixture
def file(tmp_path: Path) -> str:
    (tmp_path / "table.toml").write_text(FILE)
    return str(tmp_path / "table.toml")


@pytest.fixture
def seats(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, Any]]:
    """The options of each seat at the table that is made."""
    made: list[dict[str, Any]] = []

    def make(variant: Variant, backend: str, *, camera_delay: float = 0.0, **options: Any) -> RobotSeat:
        assert backend == "table"
        made.append({"camera_delay": camera_delay, **options})
        delays = {"camera_delay": camera_delay, "command_delay": options["command_delay"]}
        return make_robot_seat(variant, "twin", **delays, opponent="bank_shot")

    monkeypatch.setattr(meetings, "make_robot_seat", make)
    return made


@pytest.mark.slow
def test_a_circle_at_a_physical_table(
    tmp_path: Path, file: str, seats: list[dict[str, Any]], capfd: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    made = Circle(
        out, Conditions("interceptor", ("goalie",), "table", file, 2, 9.0, 1, 1.0, None, 5), 2, lambda line: None
    )
    result = made.run([], lambda done, count: None)
    assert seats == [{"camera_delay": 0.0, "command_delay": None, "table": file}] * 2
    assert [game[3] for game in result["before"]["games"]] == ["person"] * 2
    assert result["before"]["shots"]["made"] > 0 and "face-off" in capfd.readouterr().err
    assert result["in_simulator"]["before"].keys() == {"unchanged"}
    assert result["against_truth"] is None and result["films"] == {}
    html = (out / "gap.html").read_text(encoding="utf-8")
    assert f"interceptor on the physical table of {file}" in html and "concealed" not in html
    assert f"--backend table --table {file}" in html and "at the table a person" in html

    content = json.loads((out / "diagnosis" / "diagnosis.json").read_text())
    late = [
        finding("camera_delay", "sensing", delay_s=0.003),
        finding("command_delay", "gantry", delay_s=0.002),
    ]
    (out / "diagnosis" / "diagnosis.json").write_text(json.dumps(content | {"findings": late}))
    made.run(["allowing"], lambda done, count: None)
    assert seats[2:] == [{"camera_delay": 0.003, "command_delay": 0.002, "table": file}] * 2
    with pytest.raises(ValueError, match=r"a circle of .*table.toml has no truth to be held against; leave it out"):
        overview([result])


def test_games_that_a_person_played_are_kept_whatever_the_version(
    tmp_path: Path, file: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    conditions = Conditions("interceptor", ("goalie",), "table", file, 2, 9.0, 1, 1.0, None, 5)
    games = CircleFolder(tmp_path, conditions).meetings_before()
    played = meetings.PlayedMeeting(1, (2, 1), 9.0, 12.0, 1.0, 12.0, opponent="person")
    monkeypatch.setattr(meetings, "play_meeting", lambda meeting, recording: played)
    for code in ("before", "after"):
        monkeypatch.setattr(meetings, "code_version", lambda *_, code=code: code)
        assert meetings.play_all(games, tmp_path, 1, lambda done, count: None) == [played, played]
        monkeypatch.setattr(meetings, "play_meeting", None)


@pytest.mark.parametrize("arm", [name for name, arm in ARMS.items() if arm.simulator and not arm.needs_truth])
def test_every_arm_learns_on_the_table_of_the_file(tmp_path: Path, file: str, arm: str) -> None:
    """Its sizes, and its friction where no other was found or is drawn. The voltage that motors ever get is another
    matter than the supply's."""
    silent_diagnosis(tmp_path)
    (tmp_path / "before" / "recordings" / "game_0").mkdir(parents=True)
    made = simulator_of(arm, tmp_path, find_gap_table("table", file))
    assert made is not None and dict(made.values).items() >= {**SIZES, **AT_TABLE}.items()
    tables = Tables("match-v0", 2, effects=as_content(made.values), draws=made.draws)
    assert all((tables.params[name] == size).all() for name, size in SIZES.items())
    known = arm not in ("constants", "corrected")
    assert (tables.params["friction"] == 0.1).all() == known


def silent_diagnosis(folder: Path) -> None:
    sizes = "".join(f"{name} = {size}\n" for name, size in SIZES.items())
    found = {"baseline": {"parameters": {"friction": {"value": 0.11}}}, "findings": []}
    texts = {
        "effects.toml": SILENT_EFFECTS.replace("length = 2.0\n", sizes), "diagnosis.json": json.dumps(found),
        "draws.toml": SILENT_DRAWS.replace("friction = 0.11\n", f"friction = 0.11\n{sizes}", 1),
    }  # fmt: skip
    (folder / "diagnosis").mkdir()
    for name, text in texts.items():
        (folder / "diagnosis" / name).write_text(text)


def test_the_person_meets_the_arms_in_mixed_order_and_is_not_told_which_it_is(
    tmp_path: Path, file: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    silent_diagnosis(tmp_path)
    conditions = Conditions("interceptor", ("goalie",), "table", file, 4, 9.0, 1, 1.0, None, 5)
    folder, said, played = CircleFolder(tmp_path, conditions), [], []
    arms = ["allowing", "unchanged", "corrected"]
    for arm in arms[1:]:
        folder.trained(arm).parent.mkdir()
        folder.trained(arm).touch()
    monkeypatch.setattr(stages, "simulate", lambda *_: None)
    monkeypatch.setattr(stages, "play_all", lambda games, out, *_: played.append((out.parent.name, games[0].seed)))
    stages.replay(stages.Work(folder, arms, 2, said.append, lambda done, count: None))
    assert sorted(played) == sorted((arm, seed) for arm in arms for seed in range(5, 9))
    assert [seed for _, seed in played] == sorted(seed for _, seed in played)
    assert len({tuple(arm for arm, of in played if of == seed) for seed in range(5, 9)}) > 1
    assert said[0] == "playing on the table: game 1 of 12" and not any(arm in line for arm in arms for line in said)


def test_another_file_of_the_table_is_another_circle(
    tmp_path: Path, file: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["gap", "interceptor", "--backend", "table", "--stage", "tune", "--arms", "allowing", "--out", "out"]
    assert main([*words, "--table", "table.toml"]) == 2
    assert "run the stage 'diagnose' first" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
    monkeypatch.setitem(stages.STAGES, "tune", lambda work: None)  # pyright: ignore[reportArgumentType] - a dict
    assert main([*words, "--table", "table.toml"]) == 0
    kept = json.loads((tmp_path / "out" / "conditions.json").read_text())
    assert kept["table"] == file and len(kept["table_contents"]) == 12
    Path(file).write_text(FILE.replace("friction = 0.1", "friction = 0.2"))
    assert main([*words, "--table", file]) == 2
    assert "has a circle with other contents of the table's file" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ([], "--backend table needs one --table FILE; puckpilot table check --example prints one"),
        (["--table", "FILE", "--table", "FILE"], "--backend table needs one --table FILE; it is given 2 times"),
        (["--table", "FILE", "--arms", "truth"], "--arms truth needs a truth that is known"),
        (["--table", "walls"], "walls"),
        (["--table", "FILE", "--games", "1"], "--games is 1"),
    ],
)
def test_what_cannot_be_is_said_in_one_line(
    given: list[str], said: str, file: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [file if word == "FILE" else word for word in given]
    assert main(["gap", "--backend", "table", *words, "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_an_unknown_or_forgotten_backend_is_refused_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["gap", "--backend", "tabel"]) == 2
    assert "did you mean 'table'" in capsys.readouterr().err
    assert main(["gap", "--table", "table.toml"]) == 2
    assert "--table is the file table.toml, which --backend table takes; without that, a name: none" in (
        capsys.readouterr().err
    )
