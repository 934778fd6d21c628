"""The two-point procedure: the equations against the kinematics of report 37 and 38, and the command on a robot."""

from __future__ import annotations

import json
import math
import os
import threading
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import puckpilot
from sim2real.link.two_points import Shafts, solve

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


def test_a_jig_that_stands_otherwise_in_the_second_corner_is_told():
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
    shafts, way = Shafts(), [0.0, 1.0, 2.5, 5.0, 7.9, 10.0, 7.5, 4.6, 2.0, -0.9, -3.7]
    for angle in way:
        raw = round(angle / (2 * math.pi) * 16384) % 16384
        shafts.take((raw, (16384 - raw) % 16384))
    assert shafts.angles == pytest.approx((way[-1], -way[-1]), abs=1e-3)


@pytest.fixture
def robot(tmp_path: Path):
    """An emulated robot whose mallet a hand moves from the right-hand corner to the left-hand one after a second."""
    pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")
    from firmware import ELF
    from sim2real.emulate.gantry import Gantry
    from sim2real.emulate.machine import Machine
    from sim2real.emulate.paced import serve, terminal

    ended = threading.Event()
    machine = Machine(ELF)
    gantry = Gantry(machine, place=CORNER, zero=(0.3, -4.0))

    def hand(seconds: float) -> bool:
        share = min(max(seconds - 2.0, 0.0), 1.0)
        gantry.axes[1].rest = CORNER[1] + share * (WIDTH - 2.0 * CORNER[1])
        return not ended.is_set()

    with terminal(tmp_path / "board") as (descriptor, name):
        thread = threading.Thread(target=serve, args=(machine, descriptor, hand))
        thread.start()
        yield name
        ended.set()
        thread.join()


def call(robot: str, entered: list[float], monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    """The command, with Enter pressed after so many seconds each."""
    reads, writes = os.pipe()
    for seconds in entered:
        threading.Timer(seconds, os.write, (writes, b"\n")).start()
    with os.fdopen(reads) as stdin:
        monkeypatch.setattr("sys.stdin", stdin)
        code = puckpilot.main(["calibrate", "gantry", robot, *words])
    os.close(writes)
    return code


def test_the_command_finds_the_radius_of_an_emulated_gantry(
    robot: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    out = tmp_path / "gantry.toml"
    words = ["--jig", "0.0095", "0.0045", "--out", str(out), "--json"]
    assert call(robot, [1.0, 9.0], monkeypatch, *words) == 0  # the hand is done after 3 s, or later on a busy machine
    told = capsys.readouterr()
    found = json.loads(told.out)
    assert found["pulley_radius"] == pytest.approx(0.035306, abs=2e-6) and abs(found["sideways"]) < 1e-4
    assert "right-hand corner" in told.err and "left-hand corner" in told.err
    from sim2real.nominal import read_baseline

    assert read_baseline(out)["pulley_radius"] == pytest.approx(0.035306, abs=2e-6)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--jig", "5", "5"], "--jig is 5 5; expected two distances"),
        (["--jig", "-0.1", "0"], "--jig is -0.1 0; expected two distances"),
        (["--out", "/dev/null/gantry.toml"], "/dev/null"),
        (["--out", "/tmp"], "--out is /tmp, a folder; expected a file"),
    ],
)
def test_what_cannot_be_is_told_before_anybody_moves_a_mallet(
    words: list[str], told: str, capsys: pytest.CaptureFixture[str]
):
    assert puckpilot.main(["calibrate", "gantry", "/dev/none", *words]) == 2
    found = capsys.readouterr()
    assert told in found.err and found.err.count("\n") == 1 and not found.out


def test_a_mallet_that_was_not_moved_is_told_in_one_line(
    robot: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    assert call(robot, [0.6, 0.9], monkeypatch, "--out", str(tmp_path / "gantry.toml")) == 2
    told = capsys.readouterr().err.splitlines()
    assert told[-1].startswith("puckpilot calibrate gantry: both shafts together turned by 0.00 rad")
    assert not (tmp_path / "gantry.toml").exists()
