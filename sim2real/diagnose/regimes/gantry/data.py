"""The data of the gantry: the mallet's path, its drive inputs, and the residuals of the simulated response."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from sim2real.diagnose.regimes.base import UnusableError
from sim2real.diagnose.regimes.gantry.drive_inputs import DriveInputs, from_commands, from_drive
from sim2real.diagnose.regimes.gantry.path.friction import path_of_friction
from sim2real.diagnose.regimes.gantry.path.response import axis_residuals
from sim2real.diagnose.regimes.gantry.tuned import GANTRY_DATA
from sim2real.diagnose.regimes.gantry.windows import StreamWindows, cut_windows
from sim2real.recording.folder import Recording
from sim2real.segmentation.sensor_noise import Noise, estimate_noise

START_COLUMNS = 3  # free starting modes of a window and axis: rest, slow, fast; projected out of the residuals
ARRAYS = ("t", "observed", "place", "velocity", "noise")  # fields with one entry per sample


@dataclass(frozen=True)
class GantryRecording:
    """A mallet's path and its drive inputs in the recording `name`.

    `observed` (n, 2) [m]: positions at `t` (n,) [s], with standard deviations `noise` (n, 2) [m]; `place` (n, 2) [m],
    `velocity` (n, 2) [m/s]: the smoothed path.
    """

    name: str
    drive_inputs: DriveInputs
    t: np.ndarray
    observed: np.ndarray
    place: np.ndarray
    velocity: np.ndarray
    noise: np.ndarray
    windows: StreamWindows

    def with_tick(self, tick: float) -> GantryRecording:
        """A copy in which changes take effect at multiples of the control loop's period `tick` [s]."""
        return replace(self, drive_inputs=replace(self.drive_inputs, tick=tick))

    def first_windows(self, count: int) -> GantryRecording:
        """A copy with only the first `count` windows, each a cluster."""
        begin, end = self.windows.begin[:count], self.windows.end[:count]
        kept = {name: getattr(self, name)[: end[-1]] for name in ARRAYS}
        windows = StreamWindows(begin, end, np.arange(len(begin)), self.windows.parted[:count])
        return replace(self, windows=windows, **kept)

    def thinned(self, samples: int) -> GantryRecording:
        """A copy with every k-th sample, about `samples` in total; of a long record, with every m-th cluster alone."""
        most = max(samples // GANTRY_DATA.thin_window, 1)
        kept = self.windows.every(-(-len(self.windows.begin) // most))
        k = max(1, len(self.t) * len(kept.begin) // (len(self.windows.begin) * samples))
        windows = replace(kept, begin=-(-kept.begin // k), end=-(-kept.end // k))
        return replace(self, windows=windows, **{name: getattr(self, name)[::k].copy() for name in ARRAYS})

    def freedom(self) -> np.ndarray:
        """Degrees of freedom (clusters,): residuals of each cluster minus the starting columns of its windows."""
        sizes = 2 * (self.windows.end - self.windows.begin - START_COLUMNS)
        return np.bincount(self.windows.cluster, sizes, self.windows.clusters)

    def friction(self, p: np.void, delay: float = 0.0) -> np.ndarray:
        """The part (n, 2) [m] of the path that dry friction causes; `delay` [s]: of all changes."""
        changes, volts = self.drive_inputs.at_motors(p)
        unknown = np.ascontiguousarray(self.drive_inputs.unknown[:, 0])
        return path_of_friction(p, changes + delay, volts, unknown, self.t, self.observed, self.velocity, self.windows)

    def residuals(
        self, p: np.void, delay: float = 0.0, extra: np.ndarray | None = None, friction: np.ndarray | None = None
    ) -> np.ndarray:
        """Whitened residuals (2 rows, 1 + k) of all windows, x before y, with the starts projected out.

        `delay` [s]: delay of all changes. `extra` (n, 2, k) [m]: further columns of the path, transformed in the same
        way. `friction` (n, 2) [m]: the path's part by friction, if it is known.
        """
        extra = np.zeros((len(self.t), 2, 0)) if extra is None else extra
        changes, volts = self.drive_inputs.at_motors(p)
        uncertain = self.drive_inputs.uncertain_switches(p)
        dry = self.friction(p, delay) if friction is None else friction
        rows, found = self.windows.rows, []
        for axis in range(2):
            out = np.empty((len(self.t), 1 + extra.shape[2]))
            columns = (self.observed[:, axis], dry[:, axis], 1.0 / self.noise[:, axis])
            axis_residuals(
                p, axis, changes + delay, volts[:, axis].copy(), uncertain, self.t, *(c.copy() for c in columns),
                self.windows.begin, self.windows.end, np.ascontiguousarray(extra[:, axis]), out,
            )  # fmt: skip
            found.append(out[rows])
        return np.concatenate(found)

    def cluster_of_rows(self) -> np.ndarray:
        """The cluster of each row of `residuals`."""
        return np.tile(np.repeat(self.windows.cluster, self.windows.end - self.windows.begin), 2)


def read_gantry(recording: Recording, supply: float, breaks: np.ndarray) -> GantryRecording:
    """Read the gantry's data from `recording`.

    `supply` [V]; `breaks` (k,) [s]: times at which the puck pushed the mallet. Raises UnusableError if the data are too
    few or incomplete.
    """
    if recording.mallet is None:
        raise UnusableError("the mallet's path was not recorded (mallet.csv)")
    drive_inputs = find_drive_inputs(recording, supply)
    mallet = recording.mallet
    p = np.column_stack([mallet["mallet_x"], mallet["mallet_y"]])
    usable = np.isfinite(p).all(axis=1) & drive_inputs.known_at(mallet.t, GANTRY_DATA.longest_delay)
    t, p = mallet.t[usable], p[usable]
    unknown = np.unique(drive_inputs.unknown)
    windows = cut_windows(t, unknown)
    _check_enough(windows)
    if p.std(axis=0).max() < GANTRY_DATA.least_travel:
        raise UnusableError("the mallet hardly moves")
    noise = encoder_noise(t, p)
    spare = float(np.median(np.diff(t))) * GANTRY_DATA.spare_samples * GANTRY_DATA.fewest_samples
    sparsest = int(GANTRY_DATA.window / spare)
    stride = max(1, min(round(len(t) / GANTRY_DATA.most_samples), sparsest))
    t, p = t[::stride].copy(), p[::stride].copy()
    place, velocity = smoothed(t, p)
    windows = cut_windows(t, np.concatenate([breaks, unknown]))
    _check_enough(windows)
    return GantryRecording(recording.name, drive_inputs, t, p, place, velocity, noise.std(velocity), windows)


def _check_enough(windows: StreamWindows) -> None:
    if len(windows.begin) < GANTRY_DATA.fewest_windows:
        seconds, expected = (GANTRY_DATA.window * count for count in (len(windows.begin), GANTRY_DATA.fewest_windows))
        raise UnusableError(
            f"mallet path and drive inputs overlap for {seconds:.1f} s, expected {expected:g} s or more"
        )


def find_drive_inputs(recording: Recording, supply: float) -> DriveInputs:
    """The motors' drive inputs from their log, or else from the plans, which a board's feedback changes. Raises
    UnusableError if neither exists."""
    sources = (
        ("drive", recording.drive, lambda drive: from_drive(drive, supply)),
        ("commands", recording.commands, from_commands),
    )
    recorded = [(name, read(stream)) for name, stream, read in sources if stream is not None and stream.rows]
    if not recorded:
        raise UnusableError("neither the motors' log (drive.csv) nor the plans (commands.csv) was recorded")
    name, drive_inputs = next(((name, one) for name, one in recorded if len(one.t)), recorded[0])
    if not len(drive_inputs.t):
        raise UnusableError(f"{name}.csv holds no complete row")
    return drive_inputs


def smoothed(t: np.ndarray, observed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Smooth positions `observed` (n, 2) [m] at `t` (n,) [s] by a moving average over `GANTRY_DATA.smoothing`.

    Returns place [m] and velocity [m/s], each (n, 2). No average extends across a hole in the stream.
    """
    period = float(np.median(np.diff(t)))
    edges = [0, *(np.flatnonzero(np.diff(t) > GANTRY_DATA.longest_hole * period) + 1), len(t)]
    parts = [
        _smoothed(t[a:b], observed[a:b], max(1, round(0.5 * GANTRY_DATA.smoothing / period)))
        for a, b in pairwise(edges)
    ]
    place, velocity = (np.concatenate(each) for each in zip(*parts, strict=True))
    return place, velocity


def _smoothed(t: np.ndarray, observed: np.ndarray, half: int) -> tuple[np.ndarray, np.ndarray]:
    padded = np.pad(observed, ((half, half), (0, 0)), mode="edge")
    total = np.cumsum(np.vstack([np.zeros(2), padded]), axis=0)
    place = (total[2 * half + 1 :] - total[: -2 * half - 1]) / (2 * half + 1)
    return place, np.gradient(place, t, axis=0) if len(t) > 1 else np.zeros_like(place)


def encoder_noise(t: np.ndarray, p: np.ndarray) -> Noise:
    """Noise of the positions `p` (n, 2) [m] at `t` (n,) [s], at least the rounding error of the encoders,
    step / sqrt(12)."""
    noise = estimate_noise(t, p)
    return replace(noise, position=max(noise.position, smallest_step(p) / np.sqrt(12.0)))


def smallest_step(p: np.ndarray) -> float:
    """The step [m] to which positions (n, 2) are rounded: a low quantile of neighbours' differences; 0 if unknown."""
    moves = np.abs(np.diff(p, axis=0)).ravel()
    moves = moves[moves > GANTRY_DATA.same_step]
    return float(np.quantile(moves, 0.01)) if len(moves) else 0.0
