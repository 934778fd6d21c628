"""What is recorded of the twin, diagnosed: the plain twin lacks nothing, and what its law conceals is named.

The twin's physics, firmware and camera share no code with the diagnosis; its board knows what its motors really got.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

import puckpilot
from sim2real.diagnose.pipeline import Diagnosis, diagnose
from sim2real.recording.folder import Recording, read_recording
from sim2real.table.game.game_record import GameRecord
from sim2real.table.game.loop import Loop
from sim2real.table.game.robot_seat import RobotSeat, make_robot_seat
from sim2real.table.recorder.excitation import VOLTS, excite_gantry
from sim2real.table.recorder.launches import record_launches
from sim2real.table.recorder.recorded_game import recorded
from sim2real.table.twin.twin import Twin, law_of

MATCH = "puckpilot/match-v0"
SUPPLY = 24.0  # V


def seat(**concealed: float) -> RobotSeat:
    """The seat at a twin whose law has something concealed."""
    law = replace(law_of(GameRecord(MATCH).p), **concealed)  # type: ignore[arg-type] - fields that are numbers
    return make_robot_seat(MATCH, "twin", seed=3, opponent="still", law=law)


def twin_of(env: RobotSeat) -> Twin:
    twin = env.backend
    assert isinstance(twin, Twin)
    return twin


def made(env: RobotSeat, folder: Path, program: Callable[[RobotSeat], object]) -> Recording:
    with recorded(env, folder, "a test"):
        env.backend.connect(Loop(env.backend, env.game).home)
        program(env)
    return read_recording(folder)


def gantry(env: RobotSeat) -> None:
    excite_gantry(env.backend, env.game.p, 10.0, VOLTS, 1, lambda done, total: None)


def launches(env: RobotSeat) -> None:
    record_launches(env.backend, env.game.p, 20.0, 3, lambda line: None, lambda done, total: None)


def diagnosed(recording: Recording) -> Diagnosis:
    return diagnose([recording], [], {}, lambda stage, share: None)


def regime(found: Diagnosis, name: str) -> float:
    """The cross-validation residuals of a regime, in units of the noise."""
    times = next(one.times_noise for one in found.regime_results if one.regime == name)
    assert times is not None
    return times


@pytest.mark.slow
def test_the_plain_gantry_lacks_nothing_and_its_motors_got_what_is_recorded(tmp_path: Path) -> None:
    env, given = seat(), []
    twin = twin_of(env)

    def program(env: RobotSeat) -> None:
        gantry(env)
        assert twin.board is not None
        given.extend(twin.board.machine.pwm)

    recording = made(env, tmp_path / "one", program)
    found = diagnosed(recording)
    assert found.verdict in ("agrees", "parameters_only") and regime(found, "gantry") < 1.2
    assert rms_error(recording, np.array(given)) < 0.02  # V; a plan gives up to 14


def rms_error(recording: Recording, given: np.ndarray) -> float:
    """The rms error [V] of the duties in drive.csv against those that the emulated motors `given` (n, 3) got, at times
    [us] of another clock: the shift is the one at which they agree best."""
    drive = recording.drive
    assert drive is not None
    times, duties = given[:, 0] * 1e-6, given[:, 1:]
    found = np.column_stack([drive["pwm_left"], drive["pwm_right"]])
    first = times[duties.any(axis=1)][0] - drive.t[found.any(axis=1)][0]
    errors = []
    for shift in first + np.arange(-2e-3, 2e-3, 1e-4):
        row = np.searchsorted(times, drive.t + shift, side="right") - 1
        errors.append(np.sqrt(np.mean((duties[row] - found) ** 2)))
    return SUPPLY * float(min(errors))


@pytest.mark.long
def test_a_supply_that_sags_is_named(tmp_path: Path) -> None:
    found = diagnosed(made(seat(voltage_sag=0.005), tmp_path / "one", gantry))
    assert [one.mechanism for one in found.findings] == ["voltage_sag"]
    sag = found.findings[0].parameters["sag"]
    assert sag.value == pytest.approx(0.005, rel=0.01)


@pytest.mark.slow
def test_a_tilted_table_is_named(tmp_path: Path) -> None:
    found = diagnosed(made(seat(tilt_x=0.03, tilt_y=-0.02), tmp_path / "one", launches))
    assert [one.mechanism for one in found.findings] == ["table_tilt"]
    tilt = found.findings[0].parameters
    assert tilt["tilt_x"].value == pytest.approx(0.03, rel=0.02)
    assert tilt["tilt_y"].value == pytest.approx(-0.02, rel=0.02)


@pytest.mark.slow
def test_the_commands(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "one"
    assert puckpilot.main(["record", str(folder), "--program", "gantry", "--volts", "5", "9", "--seconds", "1"]) == 0
    printed = capsys.readouterr().out
    assert "moves of the mallet at 5, 9 V" in printed and f"next: puckpilot identify gantry {folder}" in printed
    commands = read_recording(folder).commands
    assert commands is not None and 5.0 in set(np.abs(commands["V_x"]).round(3))
    assert 5.0 < np.abs(commands["V_x"]).max() <= 9.0  # less where the board could not brake it soon
    games = tmp_path / "games"
    words = [
        "play",
        "still",
        "--opponent",
        "still",
        "--seconds",
        "0.3",
        "--games",
        "2",
        "--record",
        str(games),
        "--json",
    ]
    assert puckpilot.main(words) == 0
    assert sorted(path.name for path in games.iterdir()) == ["game_1", "game_2"]
    assert set(read_recording(games / "game_2").streams()) == {"frames", "mallet", "commands", "drive"}
    capsys.readouterr()
    assert puckpilot.main(["record", str(folder)]) == 2
    assert capsys.readouterr().err.endswith("one: exists already; choose another name or remove it\n")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--program", "gantry", "--volts", "20"], "is 20 V; expected more than 0, at most 14 V"),
        (["--program", "puck", "--volts", "5"], "--volts is given with --program puck; give --program gantry"),
        (["--seconds", "0"], "--seconds is 0; expected more than 0"),
        (["--backend", "replay"], "--backend is replay, where nothing moves; expected twin or table"),
        (["--backend", "table"], "--backend table needs --table"),
        (["--program", "play", "--player", "goaly"], "unknown player 'goaly'; did you mean 'goalie'?"),
    ],
)
def test_mistakes_get_one_line_and_leave_nothing(
    words: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert puckpilot.main(["record", str(tmp_path / "one"), *words]) == 2
    error = capsys.readouterr().err
    assert error.startswith("puckpilot record: ") and message in error and error.count("\n") == 1
    assert not list(tmp_path.iterdir())
