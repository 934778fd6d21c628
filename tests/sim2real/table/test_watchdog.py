"""The camera's watchdog: what stops the table, and what does not."""

from __future__ import annotations

import pytest

from sim2real.camera.frame_monitor import Trouble
from sim2real.table.backend import SeenFrame
from sim2real.table.faults import Cause, TableFaultError
from sim2real.table.watchdog import CameraWatchdog

PERIOD, HERE = 1.0 / 120.0, (0.5, 0.5)


def frame(time: float, **what: object) -> SeenFrame:
    return SeenFrame(time, HERE, HERE, **what)  # pyright: ignore[reportArgumentType] - fields by name


def stopped(frames: list[tuple[float, SeenFrame | None]]) -> tuple[Cause, float] | None:
    """The cause and the time [s] at which a watchdog that is asked every millisecond stops, as `frames` come."""
    dog, left, ticks = CameraWatchdog(0.0, 120.0), list(frames), 0
    while left:
        now = 1e-3 * (ticks := ticks + 1)
        due = [one for came, one in left if came <= now and one is not None]
        left = [(came, one) for came, one in left if came > now]
        try:
            dog.check(now, due)
        except TableFaultError as fault:
            return fault.cause, now
    return None


def at_120_hz(count: int, late: float = 0.006, **what: object) -> list[tuple[float, SeenFrame | None]]:
    times = [PERIOD * (1 + number) for number in range(count)]
    return [(time + late, frame(time, **what)) for time in times]


def test_a_frame_that_is_missing_is_no_doubt_two_in_a_row_are() -> None:
    frames = at_120_hz(60)
    assert stopped(frames[:20] + frames[21:]) is None
    found = stopped(frames[:20] + frames[22:])
    assert found is not None and found[0] == Cause.CAMERA_SILENT


def test_a_silent_camera_stops_the_table_two_and_a_half_periods_after_its_last_frame() -> None:
    frames = at_120_hz(20)
    found = stopped([*frames, (1.0, None)])
    assert found is not None and found[0] == Cause.CAMERA_SILENT
    assert found[1] == pytest.approx(frames[-1][0] + 2.5 * PERIOD, abs=0.0021)


def test_one_late_frame_is_a_hiccup_three_in_a_row_stop_the_table() -> None:
    frames = at_120_hz(30)
    hiccup = [(came, frame(came - 0.06)) if number == 10 else (came, one) for number, (came, one) in enumerate(frames)]
    assert stopped(hiccup) is None
    found = stopped([(came, frame(came - 0.06)) for came, _ in frames])
    assert found is not None and found[0] == Cause.CAMERA_LATE and found[1] == pytest.approx(frames[2][0], abs=0.0011)


def test_a_camera_that_moved_stops_the_table_at_once() -> None:
    trouble = Trouble("moved", "the camera was moved; calibrate it again")
    frames = at_120_hz(5)
    frames[3] = (frames[3][0], frame(PERIOD * 4, troubles=(trouble,)))
    found = stopped(frames)
    assert (
        found is not None and found[0] == Cause.CAMERA_TROUBLE and found[1] == pytest.approx(frames[3][0], abs=0.0011)
    )


def test_two_pucks_stop_the_table_after_a_tenth_of_a_second() -> None:
    found = stopped(at_120_hz(30, pucks=2))
    assert found is not None and found[0] == Cause.SEVERAL_PUCKS and found[1] == pytest.approx(0.106, abs=0.003)
