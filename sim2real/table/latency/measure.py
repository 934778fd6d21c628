"""The measurement on a live table: the mallet makes strokes, camera and encoders watch, pings go to and fro."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, replace

import numpy as np

from sim2real.link.board_clock import WINDOW, BoardClock
from sim2real.recording.folder import Recording, Stream
from sim2real.table.backend import Place, Reading, SeenFrame, SeenMallet
from sim2real.table.board_line import POLL
from sim2real.table.faults import Cause, TableFaultError
from sim2real.table.latency.strokes import strokes
from sim2real.table.live_table import LiveTable
from sim2real.table.mallet_driver import MalletDriver, operating_volts
from sim2real.table.recorder.motor_log import Duties, MotorLog

SETTLING = 1.0  # s of pings before the first stroke
PAUSE = 0.03  # s of rest after a stroke
LOOK = 0.5 * POLL  # s between looks at what came
NEAR = 0.15  # m from the mallet's place by its encoders: as far as a late frame and a ring of another height put it
SURE = 0.5 * WINDOW  # s after which a time of the board's clock is taken: then pings from before and after it are used


@dataclass(frozen=True)
class Echo:
    """What pings said while the mallet moved: `round_trips` (n,) [s] on the line, and of the board's clock the bound of
    the error [s], the drift and the bound of its error [1]."""

    round_trips: np.ndarray
    clock_error: float
    drift: float
    drift_error: float


@dataclass(frozen=True)
class Measurement:
    """All that a measurement saw: a `recording` with the streams frames (and in it the robot's ring, `robot_x` and
    `robot_y`), mallet and drive, on the host's clock.

    `arrived` (frames, 2) [s]: for each frame, when it had not come yet and when it had; `echo`: of the line.
    """

    recording: Recording
    arrived: np.ndarray
    echo: Echo


def measure(table: LiveTable, p: np.void, home: Place, seconds: float) -> Measurement:
    """Move the mallet to and fro for `seconds` [s] and record. The table is connected here, and is stopped in the end.

    p: the table's parameters; home: where the strokes are centred [m]. TableFaultError, in one line, if the table
    stops.
    """
    table.connect(home)
    line, driver = table.line, MalletDriver(p)
    assert line is not None
    table.wait(table.now() + SETTLING)
    session = line.session
    ahead = table.ahead + max(session.pings.round_trips)
    driver.stand(*table.place(), table.now())
    table.read()
    watched, errors, end = _Watched(table.now(), p), [], table.now() + seconds
    for action in strokes(home):
        if table.now() >= end:
            break
        begin = table.now() + ahead
        plan = table.send(driver.plan(action, begin))
        watched.motors.send(plan)
        while table.now() < begin or not driver.standing(table.now() - PAUSE):
            table.wait(table.now() + LOOK)
            reading = table.read()
            if reading.missed:
                driver.revert()
                watched.motors.forget(plan)
            watched.take(table.now(), reading, session.clock)
        errors.append(session.clock.error_s())
    clock = session.clock
    watched.tell_times(clock, -np.inf)
    echo = Echo(np.array(session.pings.round_trips), max(errors), clock.drift, clock.drift_error)
    table.stop()
    return Measurement(watched.recording(p), np.array(watched.arrived).reshape(-1, 2), echo)


class _Watched:
    def __init__(self, now: float, p: np.void) -> None:
        self.motors = MotorLog(float(p["max_voltage"]), operating_volts(p))
        self.duties: list[Duties] = []
        self.frames: list[SeenFrame] = []
        self.mallets: list[SeenMallet] = []
        self.arrived: list[tuple[float, float]] = []
        self.times: list[float] = []  # of `mallets`, on the host's clock [s]
        self._ticks: deque[int] = deque()  # of those whose time is not taken yet, on the board's clock [us]
        self._looked = now

    def take(self, now: float, reading: Reading, clock: BoardClock) -> None:
        self.frames += reading.frames
        self.arrived += [(self._looked, now)] * len(reading.frames)
        self.mallets += reading.mallets
        self.duties += [row for one in reading.mallets for row in self.motors.take(one)]
        self._ticks += [clock.to_board(one.time) for one in reading.mallets]
        self._looked = now
        self.tell_times(clock, SURE)

    def tell_times(self, clock: BoardClock, after: float) -> None:
        """Take the host's times of telemetry that is older than `after` [s]."""
        while self._ticks and self._looked - clock.to_host(self._ticks[0]) > after:
            self.times.append(clock.to_host(self._ticks.popleft()))

    def recording(self, p: np.void) -> Recording:
        if not self.frames or not self.mallets:
            what = "frame" if self.mallets else "telemetry"
            raise TableFaultError(Cause.NOT_READY, f"no {what} came while the mallet moved; see puckpilot link test")
        t = np.array(self.times)
        path = _columns("expected", [one.path for one in self.mallets])
        mallet = {"t": t, **_columns("mallet", [one.place for one in self.mallets]), **path}
        seen = _with_robot_ring(self.frames, t, np.array([one.place for one in self.mallets]))
        frames = {"t": np.array([one.time for one in seen])}
        for name in ("puck", "opponent", "robot"):
            frames |= _columns(name, [getattr(one, name) for one in seen])
        meta = {
            "table": {"length_m": float(p["length"]), "width_m": float(p["width"])},
            "gantry": {"supply_V": float(p["max_voltage"]), "pulley_radius_m": float(p["pulley_radius"])},
        }
        return Recording("measurement", meta, Stream(frames), Stream(mallet), drive=_drive(t, self.duties))


def _with_robot_ring(frames: list[SeenFrame], t: np.ndarray, path: np.ndarray) -> list[SeenFrame]:
    """The frames; a ring that was detected near the robot's mallet is the robot's, and not the opponent's.

    The mallet was at `path` (n, 2) [m] at the times `t` (n,) [s]. The detector knows one ring, wherever it is.
    """
    found = []
    for frame in frames:
        ring, at = frame.opponent, [float(np.interp(frame.time, t, column)) for column in path.T]
        own = frame.robot is None and ring is not None and math.dist(ring, at) < NEAR
        found.append(replace(frame, robot=ring, opponent=None) if own else frame)
    return found


def _columns(name: str, places: list[Place | None]) -> dict[str, np.ndarray]:
    x, y = np.array([one or (np.nan, np.nan) for one in places]).T
    return {f"{name}_x": x, f"{name}_y": y}


def _drive(t: np.ndarray, duties: list[Duties]) -> Stream:
    """The motors' duties of every tick: those of telemetry, at its times `t` (n,) [s], and of the ticks between."""
    times = np.sort(np.concatenate([t, 0.5 * (t[:-1] + t[1:])]))
    _, left, right = np.array(duties).T
    return Stream({"t": times, "pwm_left": left, "pwm_right": right})
