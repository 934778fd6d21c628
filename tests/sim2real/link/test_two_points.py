"""The two-point procedure: the equations against the kinematics of report 37 and 38, and the command on a robot."""

from __future__ import annotations

import json
import math
import os
import threading
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st

import puckpilot
from sim2real.link.two_points import ShaftAngles, solve

if TYPE_CHECKING:
    from sim2real.emulate.gantry import Gantry
    from sim2real.emulate.machine import Machine

WIDTH, CORNER = 1.0, (0.06, 0.055)


def angles(place: tuple[float, float], radius: float, offset: tuple[float, float]) -> tuple[float, float]:
    """What the encoders show, from `x = (T0 - T1) R/2`, `y = (-T0 - T1) R/2` of the true angles T."""
    total, apart = -2.0 * place[1] / radius, 2.0 * place[0] / radius
    return (total + apart) / 2.0 - offset[0], (total - apart) / 2.0 - offset[1]


@given(st.floats(0.01, 0.1), st.floats(-50, 50), st.floats(-50, 50))
def test_the_radius_and_the_offsets_are_found(radius: float, one: float, other: float):
    right = angles(CORNER, radius, (one, other))
    left = angles((CORNER[0], WIDTH - CORNER[1]), radius, (one, other))
    found = solve(right, left, CORNER, WIDTH)
    assert found.pulley_radius == pytest.approx(radius, rel=1e-9)
    assert found.offset == pytest.approx((one, other), abs=1e-6) and found.sideways == pytest.approx(0.0, abs=1e-9)


def test_a_jig_that_stands_otherwise_in_the_second_corner_is_reported():
    right = angles(CORNER, 0.035, (0.0, 0.0))
    left = angles((CORNER[0] + 0.007, WIDTH - CORNER[1]), 0.035, (0.0, 0.0))
    assert solve(right, left, CORNER, WIDTH).sideways == pytest.approx(0.007)


def test_the_wrong_way_is_refused():
    right, left = angles(CORNER, 0.035, (0.0, 0.0)), angles((0.06, 0.9), 0.035, (0.0, 0.0))
    with pytest.raises(ValueError, match="right-hand corner first"):
        solve(left, right, CORNER, WIDTH)
    with pytest.raises(ValueError, match="corners are"):
        solve(right, left, CORNER, 0.1)


def test_turns_are_counted_both_ways():
    shafts, way = ShaftAngles(), [0.0, 1.0, 2.5, 5.0, 7.9, 10.0, 7.5, 4.6, 2.0, -0.9, -3.7]
    for angle in way:
        raw = round(angle / (2 * math.pi) * 16384) % 16384
        shafts.take((raw, (16384 - raw) % 16384))
    assert shafts.angles == pytest.approx((way[-1], -way[-1]), abs=1e-3)


class Hand:
    """Moves an emulated mallet from the right-hand corner to the left-hand one, in the robot's own time.

    `presses` are the times [s] of Enter. The robot's clock is slower than ours where the machine is busy, so that a
    press by our clock would come while the mallet is still on its way.
    """

    def __init__(self, machine: Machine, gantry: Gantry) -> None:
        self.ended = threading.Event()
        self.presses: list[float] = []
        self.stdin = -1  # descriptor that Enter is written to, once the command runs
        self._machine, self._gantry = machine, gantry
        self._began: float | None = None

    def move(self, _: float) -> bool:
        """Move the mallet to where it is by now. Returns whether the robot goes on."""
        if self.stdin < 0:
            return not self.ended.is_set()
        seconds = self._machine.now * 1e-6
        self._began = seconds if self._began is None else self._began
        passed = seconds - self._began
        while self.presses and passed >= self.presses[0]:
            self.presses.pop(0)
            os.write(self.stdin, b"\n")
        self._gantry.axes[1].rest = CORNER[1] + min(max(passed - 3.0, 0.0), 1.0) * (WIDTH - 2.0 * CORNER[1])
        return not self.ended.is_set()


@pytest.fixture
def robot(tmp_path: Path):
    """The port of an emulated robot, and the hand that moves its mallet three seconds after the command begins."""
    pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")
    from firmware import ELF
    from sim2real.emulate.gantry import Gantry
    from sim2real.emulate.machine import Machine
    from sim2real.emulate.pseudo_terminal import serve, terminal

    machine = Machine(ELF)
    hand = Hand(machine, Gantry(machine, place=CORNER, zero=(0.3, -4.0)))
    with terminal(tmp_path / "board") as (descriptor, name):
        thread = threading.Thread(target=serve, args=(machine, descriptor, hand.move))
        thread.start()
        yield name, hand
        hand.ended.set()
        thread.join()


def call(robot: tuple[str, Hand], presses: list[float], monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    """The command, with Enter pressed at times [s] after its begin, by the robot's clock."""
    port, hand = robot
    reads, writes = os.pipe()
    hand.presses, hand.stdin = presses, writes
    with os.fdopen(reads) as stdin:
        monkeypatch.setattr("sys.stdin", stdin)
        code = puckpilot.main(["calibrate", "gantry", port, *words])
    os.close(writes)
    return code


@pytest.mark.slow
def test_the_command_finds_the_radius_of_an_emulated_gantry(
    robot: tuple[str, Hand], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    out = tmp_path / "gantry.toml"
    words = ["--jig", "0.0095", "0.0045", "--out", str(out), "--json"]
    assert call(robot, [2.0, 5.0], monkeypatch, *words) == 0
    output = capsys.readouterr()
    found = json.loads(output.out)
    assert found["pulley_radius"] == pytest.approx(0.035306, abs=2e-6) and abs(found["sideways"]) < 1e-4
    assert "right-hand corner" in output.err and "left-hand corner" in output.err
    from sim2real.recording.table_parameters import read_baseline

    assert read_baseline(out)["pulley_radius"] == pytest.approx(0.035306, abs=2e-6)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--jig", "5", "5"], "--jig is 5 5; expected two distances"),
        (["--jig", "-0.1", "0"], "--jig is -0.1 0; expected two distances"),
        (["--out", "/dev/null/gantry.toml"], "/dev/null"),
        (["--out", "/tmp"], "cannot write '/tmp': it is a folder; expected a file"),
    ],
)
def test_invalid_arguments_are_refused_before_the_mallet_is_moved(
    words: list[str], message: str, capsys: pytest.CaptureFixture[str]
):
    assert puckpilot.main(["calibrate", "gantry", "/dev/none", *words]) == 2
    found = capsys.readouterr()
    assert message in found.err and found.err.count("\n") == 1 and not found.out


def test_a_mallet_that_was_not_moved_is_reported_in_one_line(
    robot: tuple[str, Hand], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    assert call(robot, [0.6, 2.0], monkeypatch, "--out", str(tmp_path / "gantry.toml")) == 2
    output = capsys.readouterr().err.splitlines()
    assert output[-1].startswith("puckpilot calibrate gantry: both shafts together turned by 0.00 rad")
    assert not (tmp_path / "gantry.toml").exists()
