"""One recording of the gantry: the mallet's path beside its orders, and what the path has more than they explain."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from sim2real.diagnose.gantry.encoder import encoder_noise
from sim2real.diagnose.gantry.orders import Orders, from_commands, from_drive
from sim2real.diagnose.gantry.response import axis_residuals
from sim2real.diagnose.gantry.windows import FEWEST, HOLE, WINDOW, Windows, cut_windows
from sim2real.recording import Recording

FEWEST_WINDOWS = 12  # of WINDOW
SMALLEST_TRAVEL = 0.01  # m of standard deviation
ENOUGH_SAMPLES = 10_000  # of the encoders, evenly taken; more would cost time and not tell more
SPARE = 1.5  # times the fewest samples of a window, that it keeps
LATEST = 0.05  # s, after which no order that was not recorded is still obeyed
SMOOTHED = 0.009  # s, over which the path is averaged for its speed
START_COLUMNS = 3  # of a window and axis, taken out of its residuals


class UnusableError(ValueError):
    """Why a recording says nothing on the gantry, in one sentence."""


@dataclass(frozen=True)
class Run:
    """`seen` (n, 2) [m] at `t` (n,) [s], with noise of std `noise` (n, 2) [m]; `place`, `speed` (n, 2): smoothed."""

    orders: Orders
    t: np.ndarray
    seen: np.ndarray
    place: np.ndarray
    speed: np.ndarray
    noise: np.ndarray
    windows: Windows

    def with_tick(self, tick: float) -> Run:
        """The same with motors that heed a change at whole ticks [s] of their control loop."""
        return replace(self, orders=replace(self.orders, tick=tick))

    def first_windows(self, count: int) -> Run:
        """The first `count` windows alone, each a cluster."""
        begin, end = self.windows.begin[:count], self.windows.end[:count]
        kept = {name: getattr(self, name)[: end[-1]] for name in ("t", "seen", "place", "speed", "noise")}
        return replace(self, windows=Windows(begin, end, np.arange(len(begin))), **kept)

    def thinned(self, samples: int) -> Run:
        """The same with every k-th sample, so that about `samples` are left."""
        k = max(1, len(self.t) // samples)
        windows = Windows(-(-self.windows.begin // k), -(-self.windows.end // k), self.windows.cluster)
        return replace(
            self, windows=windows,
            **{name: getattr(self, name)[::k].copy() for name in ("t", "seen", "place", "speed", "noise")},
        )  # fmt: skip

    def freedom(self) -> np.ndarray:
        """How many residuals of each cluster the starts leave free."""
        sizes = 2 * (self.windows.end - self.windows.begin - START_COLUMNS)
        return np.bincount(self.windows.cluster, sizes, self.windows.clusters)

    def residuals(self, p: np.void, late: float = 0.0, extra: np.ndarray | None = None) -> np.ndarray:
        """Residuals (2 rows, 1 + k) of all windows, x before y, in units of the noise, starts taken out.

        `late` [s]: by which all changes come later. `extra` (n, 2, k) [m]: further columns of the path, treated alike.
        """
        extra = np.zeros((len(self.t), 2, 0)) if extra is None else extra
        changes, volts = self.orders.at_motors(p)
        loose = self.orders.loose(p)
        rows, found = self.windows.rows, []
        for axis in range(2):
            out = np.empty((len(self.t), 1 + extra.shape[2]))
            columns = (self.seen[:, axis], 1.0 / self.noise[:, axis])
            axis_residuals(
                p, axis, changes + late, volts[:, axis].copy(), loose, self.t, *(c.copy() for c in columns),
                self.windows.begin, self.windows.end, np.ascontiguousarray(extra[:, axis]), out,
            )  # fmt: skip
            found.append(out[rows])
        return np.concatenate(found)

    def cluster_of_rows(self) -> np.ndarray:
        """The cluster of each row of `residuals`."""
        return np.tile(np.repeat(self.windows.cluster, self.windows.end - self.windows.begin), 2)


def read_run(recording: Recording, supply: float, breaks: np.ndarray) -> Run:
    """The run in `recording` under a supply of `supply` [V]; `breaks` [s]: times at which something else pushed the
    mallet. Errors: UnusableError."""
    if recording.mallet is None:
        raise UnusableError("the mallet's path was not recorded (mallet.csv)")
    orders = find_orders(recording, supply)
    mallet = recording.mallet
    p = np.column_stack([mallet["mallet_x"], mallet["mallet_y"]])
    usable = np.isfinite(p).all(axis=1) & orders.known_at(mallet.t, LATEST)
    t, p = mallet.t[usable], p[usable]
    lost = np.unique(orders.unknown)
    windows = cut_windows(t, lost)
    _check_enough(windows)
    if p.std(axis=0).max() < SMALLEST_TRAVEL:
        raise UnusableError("the mallet hardly moves")
    noise = encoder_noise(t, p)
    sparsest = int(WINDOW / (float(np.median(np.diff(t))) * SPARE * FEWEST))
    stride = max(1, min(round(len(t) / ENOUGH_SAMPLES), sparsest))
    t, p = t[::stride].copy(), p[::stride].copy()
    place, speed = smoothed(t, p)
    windows = cut_windows(t, np.concatenate([breaks, lost]))
    _check_enough(windows)
    return Run(orders, t, p, place, speed, noise.std(speed), windows)


def _check_enough(windows: Windows) -> None:
    if len(windows.begin) < FEWEST_WINDOWS:
        seconds, expected = WINDOW * len(windows.begin), WINDOW * FEWEST_WINDOWS
        raise UnusableError(f"mallet and orders overlap for {seconds:.1f} s, expected {expected:g} s or more")


def find_orders(recording: Recording, supply: float) -> Orders:
    """What the motors were asked for: by the plans, else by the motors' log. Errors: UnusableError."""
    ways = (
        ("commands", recording.commands, from_commands),
        ("drive", recording.drive, lambda drive: from_drive(drive, supply)),
    )
    recorded = [(name, read(stream)) for name, stream, read in ways if stream is not None and stream.rows]
    if not recorded:
        raise UnusableError("neither the plans (commands.csv) nor the motors' log (drive.csv) was recorded")
    name, orders = next(((name, one) for name, one in recorded if len(one.t)), recorded[0])
    if not len(orders.t):
        raise UnusableError(f"{name}.csv holds no complete row")
    return orders


def smoothed(t: np.ndarray, seen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Place [m] and speed [m/s], each (n, 2), of the path seen at `t`, averaged over SMOOTHED; not across holes."""
    period = float(np.median(np.diff(t)))
    edges = [0, *(np.flatnonzero(np.diff(t) > HOLE * period) + 1), len(t)]
    parts = [_smoothed(t[a:b], seen[a:b], max(1, round(0.5 * SMOOTHED / period))) for a, b in pairwise(edges)]
    place, speed = (np.concatenate(each) for each in zip(*parts, strict=True))
    return place, speed


def _smoothed(t: np.ndarray, seen: np.ndarray, half: int) -> tuple[np.ndarray, np.ndarray]:
    padded = np.pad(seen, ((half, half), (0, 0)), mode="edge")
    total = np.cumsum(np.vstack([np.zeros(2), padded]), axis=0)
    place = (total[2 * half + 1 :] - total[: -2 * half - 1]) / (2 * half + 1)
    return place, np.gradient(place, t, axis=0) if len(t) > 1 else np.zeros_like(place)
