"""What is put into a twin is read strictly, and does what it says, each thing by itself."""

from __future__ import annotations

import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from sim2real.link.wire.frames import Receiver, encode
from sim2real.link.wire.messages import Ping, Pong
from sim2real.study.independent_table.physics.law import Law
from sim2real.table.latency.injection import read_injection, truth
from sim2real.table.twin.board import BoardErrors, EmulatedBoard
from sim2real.table.twin.camera import CameraErrors, TwinCamera
from sim2real.table.twin.plant import Plant

PLACES = (0.3, 0.5), (1.7, 0.5)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["camra=0.01"], r"--inject camra=0.01: no such delay; expected NAME=VALUE with NAME of camera, drift"),
        (["camera"], r"--inject camera: no such delay; expected NAME=VALUE"),
        (["camera=nan"], r"--inject camera=nan: expected a number from 0 to 0.06 s"),
        (["drift=900"], r"--inject drift=900: expected a number from -200 to 200 ppm"),
        (["line=0.01", "line=0.02"], r"--inject line=0.02: line is given twice; leave one out"),
    ],
)
def test_mistakes_get_one_line(words: list[str], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        read_injection(words)


def test_the_truth_is_that_of_the_middle() -> None:
    """By hand: 100 ppm for 100 s are 10 ms, less 1 us for what the clock gains meanwhile."""
    true = truth(read_injection(["camera=0.02", "drift=100"]), 100.0)
    assert true["camera"] == pytest.approx(0.029997, abs=1e-6) and true["camera_drift"] == pytest.approx(100.0)
    assert true["frame"] == pytest.approx(0.026)


def test_a_frame_has_the_stamp_of_the_camera_s_clock_and_shows_the_robot_s_ring() -> None:
    plant = Plant(Law(), *PLACES)
    camera = TwinCamera(CameraErrors(noise=0.0, delay=0.03, stamp_late=0.02, drift=1e-3), seed=0)
    plant.advance(2.0)
    camera.expose(plant)
    assert camera.take(2.029) == []
    (frame,) = camera.take(2.0301)
    assert frame.time == pytest.approx(2.022) and frame.robot == pytest.approx(PLACES[0])


def test_volts_come_late_by_the_law_s_delay() -> None:
    prompt, late = Plant(Law(), *PLACES), Plant(Law(command_delay=0.0123), *PLACES)
    for plant in (prompt, late):
        plant.advance(0.1)
        plant.drive(3.0, -3.0)
        plant.advance(0.112)
    assert late.mallet(0) == pytest.approx((*PLACES[0], 0.0, 0.0)) and prompt.mallet(0)[2] > 0.1
    for plant in (prompt, late):
        plant.advance(0.15)
        plant.drive(-3.0, 3.0)
    prompt.advance(0.2)
    late.advance(0.2123)
    assert late.mallet(0) == pytest.approx(prompt.mallet(0), abs=1e-4)


def test_the_line_is_late_both_ways_and_the_crystal_gains() -> None:
    plant = Plant(Law(), *PLACES)
    board = EmulatedBoard(plant, 24.0, seed=0, errors=BoardErrors(crystal=0.01, line_delay=0.05))
    assert board.machine.now == pytest.approx(1e6 * 1.01 * board.now())
    quick = EmulatedBoard(Plant(Law(), *PLACES), 24.0, seed=0, errors=BoardErrors(crystal=0.01, line_delay=0.0))
    assert quick.read(1000) and not board.read(1000)  # what it sends of itself is on its way
    assert answered(board) - answered(quick) == pytest.approx(2 * 0.05, abs=0.002)
    assert plant.time == pytest.approx(board.now())


def answered(board: EmulatedBoard) -> float:
    """Seconds from a ping to its answer."""
    receiver, begin = Receiver(), board.now()
    board.write(encode(Ping(7)))
    while not any(isinstance(one, Pong) for one in receiver.feed(board.read(1000))):
        board.run(board.now() + 0.001)
        assert board.now() < begin + 1.0
    return board.now() - begin
