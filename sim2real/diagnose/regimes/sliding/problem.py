"""The glides as an estimation problem, and the states at their ends, from which contacts are measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.least_squares import LeastSquaresFit
from sim2real.diagnose.engine.problem import DesignMatrix
from sim2real.diagnose.regimes.sliding.candidates import glide_columns
from sim2real.diagnose.regimes.sliding.forces.basis_library import force
from sim2real.diagnose.regimes.sliding.residuals import GlideResiduals
from sim2real.diagnose.regimes.sliding.tuned import SLIDING


@dataclass(frozen=True)
class States:
    """The states of glides at their first and last frames.

    `t` (g, 2) [s]: of these frames; `motion` (g, 2, 6): place [m], velocity [m/s], and the acceleration [m/s^2] in
    addition to that by the law whose parameters are in `record` (1,); `spread` (g, 2, 4, 4): covariance of place and
    velocity due to the frames' noise; `drift` (g, 2, 4, k): changes of place and velocity by each independent standard
    deviation of the law and of the camera's calibration, common to all glides.
    """

    t: np.ndarray
    motion: np.ndarray
    spread: np.ndarray
    drift: np.ndarray
    record: np.ndarray


class GlideProblem(GlideResiduals):
    """`GlideResiduals` with candidate laws and the states at the ends of glides."""

    def columns(
        self, values: Mapping[str, float], free: Sequence[str], use: np.ndarray | None, only: Sequence[Law] = ()
    ) -> DesignMatrix:
        """See `Problem.columns`."""
        return glide_columns(self, values, free, use, only)

    def distance_of_ends(self, values: Mapping[str, float], others: Mapping[str, float]) -> float:
        """Rms distance [m] between the glides' ends under two laws, from starts fitted under the first."""
        starts, path, _ = self._fit_starts(self._record(values))
        other = self._trace(self._record(others), starts)
        last = self.data.first[1:] - 1
        return float(np.sqrt(np.mean(np.sum((path[last, :2] - other[last, :2]) ** 2, axis=1))))

    def states(self, law: LeastSquaresFit, smooth: str = "", theta: np.ndarray | None = None) -> States:
        """The states at the ends of all glides under a fitted law plus the family `smooth` with coefficients `theta`,
        if given."""
        data, record = self.data, self._record(law.values)
        _, path, by_start = self._fit_starts(record)
        whitened, added = self.errors.white(by_start[:, :2]), np.zeros((len(path), 2))
        if theta is not None:
            added = force(smooth, self.motion(path), theta)
            change = np.concatenate(self.displacements(path, law.values, added[:, :, None]), axis=1)[:, :, 0]
            starts = self._start_changes(whitened, (data.place - path[:, :2] - change[:, :2])[:, :, None])[:, :, 0]
            path = path + change + np.einsum("nai,ni->na", by_start, data.of_frame(starts))
        ends = [data.first[:-1], data.first[1:] - 1]
        inverse = np.linalg.inv(self._normal(whitened)) * self._excess(path, by_start[:, :2])[:, None, None]
        by_modes = self._start_changes(whitened, self.errors.modes(path[:, :2]))
        return States(
            np.stack([data.t[at] for at in ends], axis=1),
            np.stack([np.concatenate([path[at], added[at]], axis=1) for at in ends], axis=1),
            np.stack([by_start[at] @ inverse @ by_start[at].transpose(0, 2, 1) for at in ends], axis=1),
            np.concatenate(
                [self._drift(law, ends), np.stack([by_start[at] @ by_modes for at in ends], axis=1)], axis=3
            ),
            np.array([record]),
        )

    def _excess(self, path: np.ndarray, by_start: np.ndarray) -> np.ndarray:
        """Residual variance (g,) of each glide in units of that of the sensor noise and calibration error; 1 if it is
        not significantly larger."""
        rest = self.profiled(path, by_start, np.zeros((len(path), 2, 0)))[0]
        squares, freedom = np.add.reduceat(rest**2, 2 * self.data.first[:-1]), self.units.freedom
        return np.where(
            squares > freedom + SLIDING.excess_stds * np.sqrt(2.0 * freedom), squares / np.maximum(freedom, 1.0), 1.0
        )

    def _drift(self, law: LeastSquaresFit, ends: Sequence[np.ndarray]) -> np.ndarray:
        """Changes (g, 2, 4, k) of the states at the frames `ends` by each of the law's `directions`."""
        path = self._fit_starts(self._record(law.values)).path
        drift = np.zeros((self.data.glides, 2, 4, len(law.free)))
        for k, change in enumerate(law.directions.T):
            shifted = {
                name: BY_NAME[name].within(law.values[name] + step) for name, step in zip(law.free, change, strict=True)
            }
            other = self._fit_starts(self._record({**law.values, **shifted})).path
            drift[:, :, :, k] = np.stack([other[at] - path[at] for at in ends], axis=1)
        return drift
