"""Short stretches of glides, and the acceleration that each has more than a law foretells."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.glide.data import FEWEST_FRAMES, GlideData
from sim2real.diagnose.glide.families import Motion
from sim2real.diagnose.glide.problem import GlideProblem
from sim2real.diagnose.glide.trace import bend

SPAN = 0.7  # s of a window: the noise of its acceleration falls with the 2.5th power of this


@dataclass(frozen=True)
class Windows:
    """`w` windows, of which number i has the frames first[i] … first[i + 1] − 1 of the glides.

    `weight` (n, 2): the acceleration of a window is the sum of its frames' places times these [1/s^2]. `std` (w, 2)
    [m/s^2]: what the sensor's noise makes of it.
    """

    first: np.ndarray
    weight: np.ndarray
    std: np.ndarray

    def of(self, place: np.ndarray) -> np.ndarray:
        """Accelerations (w, 2) [m/s^2] of places (n, 2) [m]: of the parabola through each window's."""
        return np.add.reduceat(self.weight * place, self.first, axis=0)

    def mean(self, values: np.ndarray) -> np.ndarray:
        """Means over each window of values (n, …) of the frames."""
        counts = np.diff(np.append(self.first, len(values)))
        return np.add.reduceat(values, self.first, axis=0) / counts.reshape(-1, *[1] * (values.ndim - 1))


def windows(data: GlideData, span: float | None = None) -> Windows:
    """All glides in windows of about `span` [s], SPAN by default; a shorter glide is one."""
    first, weights, stds = [], [], []
    for a, b, recording in zip(data.first[:-1], data.first[1:], data.recording, strict=True):
        lasts = float(data.t[b - 1] - data.t[a])
        parts = int(np.clip(round(lasts / (span or SPAN)), 1, max((b - a) // FEWEST_FRAMES, 1)))
        for rows in np.array_split(np.arange(a, b), parts):
            first.append(int(rows[0]))
            weights.append(_second_derivative(data.t[rows], data.std[rows]))
            erring, memory = (
                weights[-1] * data.std[rows],
                data.memories[recording].covariance(data.t[rows]),
            )
            stds.append(np.sqrt(np.einsum("na,nm,ma->a", erring, memory, erring)))
    weight = np.concatenate(weights) if weights else np.zeros((0, 2))
    starts = np.array(first, int)
    return Windows(starts, weight, np.array(stds).reshape(-1, 2))


def missing(
    problem: GlideProblem, some: Windows, values: Mapping[str, float], force: np.ndarray | None = None
) -> np.ndarray:
    """Accelerations (w, 2) [m/s^2] of the windows that a law and a small further `force` (n, 2) do not foretell."""
    data = problem.data
    path = problem.linearised(values)[0]
    rest = data.place - path[:, :2]
    if force is not None:
        moved = np.empty((len(data.t), 2, 1))
        columns = np.ascontiguousarray(force[:, :, None])
        bend(data.first, data.t, path, values["friction"], values["drag"], columns, moved, np.empty_like(moved))
        rest = rest - moved[:, :, 0]
    return some.of(rest)


def motion(problem: GlideProblem, some: Windows, values: Mapping[str, float]) -> Motion:
    """The mean motion in each window under a law."""
    frames = problem.motion(problem.linearised(values)[0])
    t, place, velocity, since = (some.mean(each) for each in (frames.t, frames.place, frames.velocity, frames.since))
    launch, aged = some.mean(frames.launch), some.mean(frames.aged)
    return Motion(t, place, velocity, since, launch, aged, frames.size, frames.speeds)


def _second_derivative(t: np.ndarray, std: np.ndarray) -> np.ndarray:
    """Weights (k, 2) that take places at `t` (k,), of noise `std` (k, 2), to the acceleration of the parabola."""
    u = t - t.mean()
    design = np.vander(u, 3)
    return np.stack([2.0 * np.linalg.pinv(design / s[:, None])[0] / s for s in std.T], axis=1)
