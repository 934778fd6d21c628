"""A circle at a physical table: a person at the other end, and no truth is known. A twin stands in for it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from puckpilot import main
from puckpilot_env.options.at_table import AT_TABLE
from puckpilot_env.variants import Variant
from sim2real.gap.arms import simulator_of
from sim2real.gap.circle import Circle
from sim2real.gap.circle_folder import CircleFolder, Conditions
from sim2real.gap.gap_table import find_gap_table
from sim2real.gap.overview import overview
from sim2real.table import meetings
from sim2real.table.game.robot_seat import RobotSeat, make_robot_seat
from tests.sim2real.gap.test_against_truth import finding

FILE = """
format = "puckpilot-table/1"
[parameters]
friction = 0.1
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
        return make_robot_seat(variant, "twin", camera_delay=camera_delay, opponent="bank_shot")

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
    assert seats == [{"camera_delay": 0.0, "table": file}] * 2
    assert [game[3] for game in result["before"]["games"]] == ["person"] * 2
    assert result["before"]["shots"]["made"] > 0 and "face-off" in capfd.readouterr().err
    assert result["in_simulator"]["before"].keys() == {"unchanged"}
    assert result["against_truth"] is None and result["films"] == {}
    html = (out / "gap.html").read_text(encoding="utf-8")
    assert f"interceptor on the physical table of {file}" in html and "concealed" not in html
    assert f"--backend table --table {file}" in html and "at the table a person" in html

    content = json.loads((out / "diagnosis" / "diagnosis.json").read_text())
    late = [finding("camera_delay", "sensing", delay_s=0.003)]
    (out / "diagnosis" / "diagnosis.json").write_text(json.dumps(content | {"findings": late}))
    made.run(["allowing"], lambda done, count: None)
    assert seats[2:] == [{"camera_delay": 0.003, "table": file}] * 2
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


def test_what_the_table_s_file_states_is_learnt_on(tmp_path: Path, file: str) -> None:
    """The voltage that motors ever get is another matter than the supply's."""
    made = simulator_of("unchanged", tmp_path, find_gap_table("table", file))
    assert made is not None and dict(made.values) == {"friction": 0.1, **AT_TABLE}


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ([], "--backend table needs one --table FILE"),
        (["--table", "FILE", "--table", "FILE"], "--backend table needs one --table FILE"),
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


def test_an_unknown_backend_is_refused_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["gap", "--backend", "tabel"]) == 2
    assert "did you mean 'table'" in capsys.readouterr().err
