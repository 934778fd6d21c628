"""Live eyes: frames of a camera whose clock is its own, read at the host's time; a camera that fails."""

from __future__ import annotations

import time
from typing import Self

import numpy as np
import pytest

from sim2real.camera.frame import CameraError, Frame
from sim2real.table.backend import SeenFrame
from sim2real.table.faults import Cause, TableFaultError
from sim2real.table.physical.eyes import LiveEyes

OFFSET, DELAY = 1234.5, 0.006  # s of the camera's clock before the host's, and from exposure to arrival


class Scripted:
    """A source whose frames are given one by one."""

    def __init__(self) -> None:
        self.frame: Frame | None = None
        self.error: CameraError | None = None
        self.open = False

    over, total = False, None

    def newest(self, wait: float) -> Frame | None:
        if self.error:
            raise self.error
        frame, self.frame = self.frame, None
        return frame

    def __enter__(self) -> Self:
        self.open = True
        return self

    def __exit__(self, *_: object) -> None:
        self.open = False


class Reader:
    """Reads every frame as a puck in the middle."""

    def read(self, frame: Frame) -> SeenFrame:
        return SeenFrame(frame.time, (1.0, 0.5), None)

    warmed = checked = 0

    def check(self) -> None:
        """Its frames are always good."""
        self.checked += 1

    def keep_warm(self) -> None:
        self.warmed += 1


def test_frames_are_read_at_the_time_of_their_exposure_on_the_hosts_clock() -> None:
    source = Scripted()
    eyes = LiveEyes(source, Reader(), DELAY)  # pyright: ignore[reportArgumentType] - what it reads with
    eyes.open()
    assert source.open and eyes.take(0.0) == []
    for number in range(200):
        host = 10.0 + number / 120.0
        source.frame = Frame(np.zeros((2, 2), np.uint8), host + OFFSET, host + DELAY, number)
        eyes.rest(0.0)
        (seen,) = eyes.take(host + DELAY)
        assert seen.puck == (1.0, 0.5) and eyes.arrived == host + DELAY
        assert seen.time == pytest.approx(host, abs=2e-4)
    eyes.close()
    assert not source.open


def test_a_camera_that_fails_is_a_fault_of_the_table() -> None:
    source = Scripted()
    eyes = LiveEyes(source, Reader(), DELAY)  # pyright: ignore[reportArgumentType]
    eyes.open()
    source.error = CameraError("aravis: gives no more pictures; plug it in again")
    eyes.rest(0.0)  # a stop must be able to go on
    with pytest.raises(TableFaultError, match="plug it in again") as caught:
        eyes.take(0.0)
    assert caught.value.cause == Cause.CAMERA_SILENT


def test_a_camera_whose_clock_is_set_anew_is_placed_by_the_frame_that_says_so() -> None:
    """The clock learns of a frame a moment after it was read, unless that came when none was expected."""
    source = Scripted()
    eyes = LiveEyes(source, Reader(), DELAY)  # pyright: ignore[reportArgumentType]
    eyes.open()
    for number in range(100):
        host = 10.0 + number / 120.0
        offset = OFFSET if number < 60 else -200.0
        source.frame = Frame(np.zeros((2, 2), np.uint8), host + offset, host + DELAY, number)
        eyes.rest(0.0)
        (seen,) = eyes.take(host + DELAY)
        assert seen.time == pytest.approx(host, abs=2e-4)


def test_a_search_is_rehearsed_before_a_frame_is_due_and_at_no_other_time(monkeypatch: pytest.MonkeyPatch) -> None:
    source, reader = Scripted(), Reader()
    eyes = LiveEyes(source, reader, DELAY)  # pyright: ignore[reportArgumentType]
    eyes.open()
    monkeypatch.setattr(time, "perf_counter", lambda: now)
    warmed, checked = [], []
    for step in range(400):  # of 0.1 ms; a frame every 10 ms
        now = 10.0 + 1e-4 * step
        if step % 100 == 0:
            source.frame = Frame(np.zeros((2, 2), np.uint8), now - DELAY, now, step)
        before, checked_before = reader.warmed, reader.checked
        eyes.rest(0.0)
        eyes.take(now)
        warmed += [step] * (reader.warmed - before)
        checked += [step] * (reader.checked - checked_before)
    assert {step // 100 for step in warmed} == {1, 2, 3}  # the first period is not known yet
    within = {step % 100 for step in warmed}  # 3.0 to 1.6 ms before the next
    assert set(range(71, 84)) <= within <= set(range(70, 85))
    assert {step % 100 for step in checked if step >= 200} == set(range(1, 71))  # no frame comes meanwhile, nor is late


def test_shortly_before_a_frame_nothing_else_is_served_and_a_late_one_is_not_waited_for_long(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    source, waits = Scripted(), []
    eyes = LiveEyes(source, Reader(), DELAY)  # pyright: ignore[reportArgumentType]
    eyes.open()
    clock = [10.0]
    monkeypatch.setattr(time, "perf_counter", lambda: clock[0])
    monkeypatch.setattr(source, "newest", lambda wait: waits.append(wait))
    eyes._due = 10.01
    for clock[0] in (10.0, 10.0088, 10.0093, 10.0099, 10.0101):
        eyes.rest(0.0009)
    assert waits == pytest.approx([0.0009, 0.0017, 0.0012, 0.0009, 0.0009])
