"""A table in real time, in virtual time: the emulated board at its line, a camera whose frames are paced."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Self

import numpy as np
import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from puckpilot_env.parameters import make_records
from sim2real.camera.frame import CameraError, Frame
from sim2real.study.independent_table.physics.law import Law
from sim2real.table.backend import Place, SeenFrame
from sim2real.table.board_config import board_config
from sim2real.table.faults import Cause, TableFaultError
from sim2real.table.game.loop import home_of
from sim2real.table.mallet_driver import AHEAD, MalletDriver
from sim2real.table.physical.eyes import LiveEyes
from sim2real.table.physical.real_time import RealTimeTable
from sim2real.table.twin.board import EmulatedBoard
from sim2real.table.twin.plant import Plant

P = make_records(1)[0]
HOME, RATE, SHIFT = home_of(P), 120.0, 77.0  # s that the camera's clock is ahead

pytestmark = pytest.mark.slow


class PacedCamera:
    """A source that lets the board's time pass; its frames come `late` [s] after their exposures."""

    over, total = False, None

    def __init__(self, board: EmulatedBoard) -> None:
        self.board, self.late, self.plugged, self.opened = board, 0.0, True, 0
        self._due = board.now()

    def __enter__(self) -> Self:
        if not self.plugged:
            raise CameraError("no camera is plugged in")
        self.opened, self._due = self.opened + 1, self.board.now()
        return self

    def __exit__(self, *_: object) -> None:
        """Nothing is held open."""

    def newest(self, wait: float) -> Frame | None:
        until = self.board.now() + max(wait, 0.0)
        if not self.plugged:
            self.board.run(until)
            raise CameraError("the camera was unplugged")
        self.board.run(min(until, max(self._due, self.board.now())))
        if self._due > until:
            return None
        now, self._due = self.board.now(), self._due + 1.0 / RATE
        return Frame(np.zeros((2, 2), np.uint8), now - self.late + SHIFT, now, round(now * RATE))


class Reader:
    """Reads every frame as a puck in the middle, which takes `takes` [s]."""

    def __init__(self, board: EmulatedBoard) -> None:
        self.board, self.takes = board, 0.0

    def read(self, frame: Frame) -> SeenFrame:
        self.board.run(self.board.now() + self.takes)
        return SeenFrame(frame.time, (1.0, 0.5), (1.7, 0.5))

    def check(self) -> None:
        """Its frames are always good."""

    def keep_warm(self) -> None:
        """It needs no caches."""


class Helper:
    """Puts the mallet home and the puck nowhere."""

    def put_puck(self, puck: np.ndarray) -> None:
        """It is where the pictures have it."""

    def home_mallet(self, home: Place) -> None:
        """It is there."""

    def play(self, game: np.void) -> None:
        """Nobody plays."""


class VirtualTable(RealTimeTable):
    """A table in real time, by the board's clock."""

    def __init__(self) -> None:
        self.plant = Plant(Law(), HOME, (1.7, 0.5))
        self.board = EmulatedBoard(self.plant, float(P["max_voltage"]), seed=0)
        self.camera, self.reader = PacedCamera(self.board), Reader(self.board)
        super().__init__(
            board_config(P), RATE, lambda: self.board,
            lambda: LiveEyes(self.camera, self.reader, 0.0),  # pyright: ignore[reportArgumentType]
            lambda serve: Helper(),
        )  # fmt: skip

    def now(self) -> float:
        return self.board.now()


@pytest.fixture
def table() -> Iterator[VirtualTable]:
    with VirtualTable() as made:
        made.connect(HOME)
        yield made


def stopped(table: VirtualTable, within: float) -> TableFaultError:
    """The fault that comes in so many seconds; the mallet has stopped then."""
    with pytest.raises(TableFaultError) as raised:
        table.wait(table.now() + within)
    assert table.board.machine.motors.duties == (0.0, 0.0)
    return raised.value


def test_the_mallet_goes_where_plans_send_it_and_reactions_are_counted(table: VirtualTable) -> None:
    driver = MalletDriver(P)
    driver.stand(*HOME, table.now())
    table.wait_for_frame(table.now() + 0.02)
    plan = table.send(driver.plan([0.6, 0.3, 8.0, 8.0], table.now() + AHEAD))
    table.wait(plan.begin + max(plan.t2) + 0.05)
    assert table.plant.mallet(0)[:2] == pytest.approx((0.6, 0.3), abs=0.001)
    reading = table.read()
    assert 0.0 <= reading.late_s < 0.01 and reading.frames[-1].puck == (1.0, 0.5)
    assert len(table.reactions) == 1 and 0.0 <= table.reactions[0] < 0.002


@pytest.mark.parametrize("takes", [0.001, 0.003, 0.005, 0.007])
def test_a_reaction_counts_however_late_it_is(table: VirtualTable, takes: float) -> None:
    """Also where the frame was read after the moment until which it was waited for."""
    driver, half_frame = MalletDriver(P), 0.48 / RATE
    driver.stand(*HOME, table.now())
    table.wait_for_frame(table.now() + 0.02)
    due = table.now() + 1.0 / RATE
    table.wait(due - half_frame)
    table.reader.takes = takes
    table.wait_for_frame(due + half_frame)
    table.send(driver.plan([0.3, 0.5, 5.0, 5.0], table.now() + AHEAD))
    assert len(table.reactions) == 1 and table.reactions[0] == pytest.approx(takes, abs=0.0011)


def test_a_frame_that_comes_is_read_before_the_line_while_the_board_still_hears_of_the_host(
    table: VirtualTable, monkeypatch: pytest.MonkeyPatch
) -> None:
    table.wait(table.now() + 0.1)
    said: list[str] = []
    assert table.line is not None and table.eyes is not None
    take = table.eyes.take
    monkeypatch.setattr(table.line, "poll", lambda: said.append("line"))
    monkeypatch.setattr(table.line, "keep_alive", lambda: said.append("alive"))
    monkeypatch.setattr(table.eyes, "take", lambda now: said.append("frame") or frames if (frames := take(now)) else [])
    table.wait_for_frame(table.now() + 0.02)
    assert said[-2:] == ["alive", "frame"] and set(said[:-2]) == {"line"}


def test_frames_that_come_later_from_some_moment_on_stop_it_and_go_on_doing_so(table: VirtualTable) -> None:
    table.wait(table.now() + 0.5)
    table.camera.late = 0.1
    assert stopped(table, 1.0).cause == Cause.CAMERA_LATE
    table.clear(HOME)  # of new frames alone nobody can tell
    assert stopped(table, 0.2).cause == Cause.CAMERA_LATE
    table.camera.late = 0.0
    table.clear(HOME)
    table.wait(table.now() + 0.2)
    assert table.read().late_s < 0.01


def test_a_camera_that_was_unplugged_is_opened_anew_when_it_is_back(table: VirtualTable) -> None:
    table.camera.plugged = False
    assert stopped(table, 0.1).cause == Cause.CAMERA_SILENT
    for _ in range(2):  # too early
        with pytest.raises(TableFaultError, match="no camera is plugged in"):
            table.clear(HOME)
    table.camera.plugged = True
    table.clear(HOME)
    table.wait(table.now() + 0.1)
    assert table.camera.opened == 2 and table.read().frames


def test_a_board_that_stops_for_a_silent_host_is_cleared_at_once(table: VirtualTable) -> None:
    table.board.run(table.now() + 0.05)  # nobody serves it
    fault = stopped(table, 0.1)
    assert fault.cause == Cause.OVERRUN and "not served for 5" in str(fault) and "stops after 12 ms" in str(fault)
    table.clear(HOME)
    table.wait(table.now() + 0.1)
