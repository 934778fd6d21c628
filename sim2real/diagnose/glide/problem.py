"""The glides as a problem for the engine, and what their ends tell of the contacts between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine.fit import Fit
from sim2real.diagnose.glide.carry import braking
from sim2real.diagnose.glide.families import force
from sim2real.diagnose.glide.glides import STEP, Glides
from sim2real.diagnose.glide.laws import glide_columns
from sim2real.diagnose.problem import Columns


@dataclass(frozen=True)
class States:
    """The ends of glides, first and last frame. `motion` (g, 2, 6): place, velocity, and the acceleration beyond that
    by `friction` and `drag`; `spread` (g, 2, 4, 4): covariance of place and velocity by the sensor's noise; `drift`
    (g, 2, 4, k): changes of them by each independent standard deviation of the law and of the camera's calibration,
    common to all glides."""

    motion: np.ndarray
    spread: np.ndarray
    drift: np.ndarray
    friction: float
    drag: float


class GlideProblem(Glides):
    """`Glides` with all that they may lack."""

    def columns(self, values: Mapping[str, float], free: Sequence[str], use: np.ndarray | None) -> Columns:
        """See `Problem.columns`."""
        return glide_columns(self, values, free, use)

    def ends_apart(self, values: Mapping[str, float], others: Mapping[str, float]) -> float:
        """How far apart [m], rms over the glides, the same starts lead under two laws; the first has them fitted."""
        path, _ = self._fit_starts(self._record(values))
        other = np.empty_like(path)
        self._trace(self._record(others), self._starts, other)
        last = self.data.first[1:] - 1
        return float(np.sqrt(np.mean(np.sum((path[last, :2] - other[last, :2]) ** 2, axis=1))))

    def states(self, law: Fit, smooth: str = "", theta: np.ndarray | None = None) -> States:
        """Each glide's motion at its first and last frame under a fitted law, with the family `smooth` on top."""
        data, record = self.data, self._record(law.values)
        path, by_start = self._fit_starts(record)
        velocity_by_start = np.empty_like(by_start)
        other = np.empty_like(path)
        for k in range(4):
            moved = self._starts.copy()
            moved[:, k] += STEP[k]
            self._trace(record, moved, other)
            velocity_by_start[:, :, k] = (other[:, 2:] - path[:, 2:]) / STEP[k]
        whole = np.concatenate([by_start, velocity_by_start], axis=1)
        if theta is not None:
            pull = force(smooth, self.motion(path), theta)
            change = np.concatenate(self.bent(path, law.values, pull[:, :, None]), axis=1)[:, :, 0]
            starts = self._answers(by_start, (data.place - path[:, :2] - change[:, :2])[:, :, None])[:, :, 0]
            path = path + change + np.einsum("nai,ni->na", whole, data.of_frame(starts))
        ends = [data.first[:-1], data.first[1:] - 1]
        inverse = np.linalg.inv(self._normal(self.errors.white(by_start))) * self._unrest(path, by_start)[:, None, None]
        bent = self._answers(by_start, self.errors.modes(path[:, :2]))
        friction, drag = float(record["friction"]), float(record["drag"])
        beyond = [
            _beyond(data.t, path[:, 2:], at, step, friction, drag) for at, step in zip(ends, (1, -1), strict=True)
        ]
        return States(
            np.stack([np.concatenate([path[at], more], axis=1) for at, more in zip(ends, beyond, strict=True)], axis=1),
            np.stack([whole[at] @ inverse @ whole[at].transpose(0, 2, 1) for at in ends], axis=1),
            np.concatenate([self._drift(law, ends), np.stack([whole[at] @ bent for at in ends], axis=1)], axis=3),
            friction,
            drag,
        )

    def _unrest(self, path: np.ndarray, by_start: np.ndarray) -> np.ndarray:
        """How much more (g,) than the sensor's noise and the calibration explain a glide scatters about its path, in
        variance; at least 1."""
        rest = self.profiled(path, by_start, np.zeros((len(path), 2, 0)))[0]
        left, freedom = np.add.reduceat(rest**2, 2 * self.data.first[:-1]), self.units.freedom
        return np.where(left > freedom + 3.0 * np.sqrt(2.0 * freedom), left / np.maximum(freedom, 1.0), 1.0)

    def _drift(self, law: Fit, ends: Sequence[np.ndarray]) -> np.ndarray:
        """By how much (g, 2, 4, k) the ends move with each of the law's `directions`."""
        path, _ = self._fit_starts(self._record(law.values))
        kept, drift = self._starts.copy(), np.zeros((self.data.glides, 2, 4, len(law.free)))
        for k, change in enumerate(law.directions.T):
            shifted = {
                name: BY_NAME[name].within(law.values[name] + step) for name, step in zip(law.free, change, strict=True)
            }
            other, _ = self._fit_starts(self._record({**law.values, **shifted}))
            drift[:, :, :, k] = np.stack([other[at] - path[at] for at in ends], axis=1)
            self._starts = kept.copy()
        return drift


def _beyond(t: np.ndarray, velocity: np.ndarray, at: np.ndarray, step: int, friction: float, drag: float) -> np.ndarray:
    """Acceleration (k, 2) [m/s^2] at the frames `at`, from the frame `step` beside them, less that by friction and
    drag."""
    beside = at + step
    slope = (velocity[beside] - velocity[at]) / (t[beside] - t[at])[:, None]
    return slope - braking(0.5 * (velocity[beside] + velocity[at]), friction, drag)
