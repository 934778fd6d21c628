"""Short windows of glides, and the residual acceleration of each under a law."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.regimes.sliding.data import GlideData
from sim2real.diagnose.regimes.sliding.forces.motion import Motion
from sim2real.diagnose.regimes.sliding.problem import GlideProblem
from sim2real.diagnose.regimes.sliding.tuned import SLIDING


@dataclass(frozen=True)
class AccelerationWindows:
    """`w` windows; window i has the frames first[i] … first[i + 1] − 1 of the glides.

    `weight` (n, 2) [1/s^2]: the acceleration of a window is the weighted sum of its frames' places. `std` (w, 2)
    [m/s^2]: its standard deviation due to sensor noise.
    """

    first: np.ndarray
    weight: np.ndarray
    std: np.ndarray

    def of(self, place: np.ndarray) -> np.ndarray:
        """Accelerations (w, 2) [m/s^2] of the parabolas through the places (n, 2) [m] of each window."""
        return np.add.reduceat(self.weight * place, self.first, axis=0)

    def mean(self, values: np.ndarray) -> np.ndarray:
        """Means over each window of values (n, …) of the frames."""
        counts = np.diff(np.append(self.first, len(values)))
        return np.add.reduceat(values, self.first, axis=0) / counts.reshape(-1, *[1] * (values.ndim - 1))


def acceleration_windows(data: GlideData, span: float | None = None) -> AccelerationWindows:
    """Divide glides into windows of about `span` [s], by default `SLIDING.window`; a shorter glide is one window."""
    first, weights, stds = [], [], []
    for a, b, recording in zip(data.first[:-1], data.first[1:], data.recording, strict=True):
        duration = float(data.t[b - 1] - data.t[a])
        parts = int(np.clip(round(duration / (span or SLIDING.window)), 1, max((b - a) // SLIDING.fewest_frames, 1)))
        for rows in np.array_split(np.arange(a, b), parts):
            first.append(int(rows[0]))
            weights.append(_second_derivative(data.t[rows], data.std[rows]))
            errors, correlation = weights[-1] * data.std[rows], data.noise[recording].correlation(data.t[rows])
            stds.append(np.sqrt(np.einsum("na,nm,ma->a", errors, correlation, errors)))
    weight = np.concatenate(weights) if weights else np.zeros((0, 2))
    starts = np.array(first, int)
    return AccelerationWindows(starts, weight, np.array(stds).reshape(-1, 2))


def missing_acceleration(
    problem: GlideProblem, windows: AccelerationWindows, values: Mapping[str, float], force: np.ndarray | None = None
) -> np.ndarray:
    """Accelerations (w, 2) [m/s^2] of the windows minus those that the parameters `values` predict.

    `force` (n, 2) [m/s^2]: a small additional force of the prediction.
    """
    data = problem.data
    path = problem.linearized(values)[0]
    rest = data.place - path[:, :2]
    if force is not None:
        rest = rest - problem.displacements(path, values, force[:, :, None])[0][:, :, 0]
    return windows.of(rest)


def mean_motion(problem: GlideProblem, windows: AccelerationWindows, values: Mapping[str, float]) -> Motion:
    """The mean motion in each window under a law."""
    frames = problem.motion(problem.linearized(values)[0])
    t, place, velocity, since = (windows.mean(each) for each in (frames.t, frames.place, frames.velocity, frames.since))
    launch, age = windows.mean(frames.launch), windows.mean(frames.age)
    return Motion(t, place, velocity, since, launch, age, frames.size, frames.speeds)


def _second_derivative(t: np.ndarray, std: np.ndarray) -> np.ndarray:
    """Weights (k, 2) of places at `t` (k,) with noise `std` (k, 2) for the acceleration of the fitted parabola."""
    u = t - t.mean()
    design = np.vander(u, 3)
    return np.stack([2.0 * np.linalg.pinv(design / s[:, None])[0] / s for s in std.T], axis=1)
