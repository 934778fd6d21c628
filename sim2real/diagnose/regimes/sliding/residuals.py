"""Residuals of glides under a law: each glide's start is fitted, and its derivatives are projected out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from puckpilot_env.parameters import BY_NAME
from puckpilot_env.physics.advance import PUCK
from sim2real.diagnose.engine.problem import Residuals, Units, record_of
from sim2real.diagnose.regimes.sliding.data import GlideData
from sim2real.diagnose.regimes.sliding.forces.motion import Motion
from sim2real.diagnose.regimes.sliding.trajectory import linear_response, trace
from sim2real.diagnose.regimes.sliding.tuned import SLIDING
from sim2real.diagnose.sensor_noise.covariance import PositionCovariance
from sim2real.statistics.piecewise import spread_knots
from sim2real.statistics.projection import project_out_of_parts

STEP = np.array(SLIDING.start_step)
KEPT = 6  # laws of which the fitted starts are kept


class FittedStarts(NamedTuple):
    """Fitted `starts` (g, 5) under a law, the `path` (n, 4) from them, and its derivatives `by_start` (n, 4, 4) by
    place and velocity of the start, from the last step of the fit."""

    starts: np.ndarray
    path: np.ndarray
    by_start: np.ndarray


class GlideResiduals:
    """Residuals of free glides.

    The `values` of its methods are simulator parameters by name; missing ones have their defaults.
    """

    regime = "glide"
    base: tuple[str, ...] = ("friction", "drag")
    first_fitted: tuple[str, ...] = base

    def __init__(self, data: GlideData, values: Mapping[str, float]) -> None:
        """`values`: the table's sizes and other parameters that all laws share."""
        self.data = data
        self.clusters = data.clusters
        self._common = dict(values)
        self._fitted: dict[bytes, FittedStarts] = {}
        self.errors = PositionCovariance(data.t, data.std, data.first, data.noise_of_glide, self._size)
        guess, speed = _first_guess(data)
        self._speeds = spread_knots(speed, SLIDING.speed_knots)
        self.units = Units(data.cluster, 2.0 * np.diff(data.first) - 4.0, "glides", _kinds(guess[:, 2:4]))
        self.freedom = np.bincount(data.cluster, self.units.freedom, data.clusters)
        common = record_of(self._common)
        path = self._trace(common, guess)
        parabolas = FittedStarts(guess, path, self._derivatives(common, guess, path))
        self._common_starts = self._refined(common, parabolas)
        self.noise_m = float(np.sqrt(np.mean(data.std**2)))
        self.place_error_m = max(one.map_error_std for one in data.noise)

    def motion(self, path: np.ndarray) -> Motion:
        """The quantities that forces depend on, along a path (n, 4) of places [m] and velocities [m/s]."""
        data = self.data
        since, launch = data.t - data.of_frame(data.since), data.of_frame(data.cluster)
        begun = np.full(data.clusters, np.inf)
        np.minimum.at(begun, launch, data.t)
        age = data.t - begun[launch]
        return Motion(data.t, path[:, :2], path[:, 2:], since, launch.astype(float), age, self._size, self._speeds)

    def residuals(self, values: Mapping[str, float], free: Sequence[str], clusters: np.ndarray) -> Residuals:
        """See `Problem.residuals`."""
        data = self.data
        starts, path, by_start = self._fit_starts(self._record(values))
        columns = np.empty((len(data.t), 2, len(free)))
        for k, name in enumerate(free):
            row = BY_NAME[name]
            step = SLIDING.parameter_step * max(row.high - row.low, SLIDING.narrowest_range)
            other = self._trace(self._record({**values, name: values.get(name, row.default) + step}), starts)
            columns[:, :, k] = (other[:, :2] - path[:, :2]) / step
        r, jacobian = self.profiled(path, by_start[:, :2], columns)
        cluster = np.repeat(data.of_frame(data.cluster), 2)
        here = np.isin(cluster, clusters)
        return Residuals(r[here], jacobian[here], cluster[here])

    def profiled(self, path, by_start, columns) -> tuple[np.ndarray, np.ndarray]:
        """Whitened residuals (2n,) of a path (n, 4) and their derivatives (2n, k), with the starts profiled out.

        `by_start` (n, 2, 4): derivatives of the places by the starts, which are projected out; `columns` (n, 2, k) [m]:
        derivatives of the predicted places by each parameter.
        """
        data, white = self.data, self.errors.white
        changes = [(data.place - path[:, :2])[:, :, None], -columns, self.errors.modes(path[:, :2])]
        rows = white(np.concatenate(changes, axis=2)).reshape(2 * len(data.t), -1)
        starts = white(by_start).reshape(len(rows), 4)
        project_out_of_parts(starts, 2 * data.first, rows)
        known = 1 + columns.shape[2]
        rows = self.errors.allowing(rows[:, known:], rows[:, :known])
        return rows[:, 0], rows[:, 1:]

    def linearized(self, values: Mapping[str, float]) -> tuple[np.ndarray, np.ndarray]:
        """The path (n, 4) under a law from fitted starts, and the derivatives (n, 2, 4) of its places by the starts."""
        _, path, by_start = self._fit_starts(self._record(values))
        return path, by_start[:, :2]

    def displacements(
        self, path: np.ndarray, values: Mapping[str, float], force: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Displacements (n, 2, k) [m] of a path (n, 4) due to small accelerations `force` (n, 2, k) [m/s^2], and their
        rates (n, 2, k) [m/s]; `values`: parameters with friction and drag."""
        moved, moving = np.empty_like(force), np.empty_like(force)
        force = np.ascontiguousarray(force)
        linear_response(self.data.first, self.data.t, path, values["friction"], values["drag"], force, moved, moving)
        return moved, moving

    def _record(self, values: Mapping[str, float]) -> np.void:
        return record_of({**self._common, **values})

    def _trace(self, record: np.void, starts: np.ndarray) -> np.ndarray:
        """The path (n, 4) of the glides from `starts` (g, 5) under a law."""
        path = np.empty((len(self.data.t), 4))
        trace(record, self.data.first, self.data.t, starts, np.zeros(1, PUCK), path)
        return path

    def _fit_starts(self, record: np.void) -> FittedStarts:
        """Fit each glide's start under a law, beginning at the common law's starts, so that fits are independent. The
        last few laws are kept: more than half of all calls ask for one of them again."""
        law = record.tobytes()
        if law not in self._fitted:
            if len(self._fitted) == KEPT:
                del self._fitted[next(iter(self._fitted))]
            self._fitted[law] = self._refined(record, self._common_starts)
        return self._fitted[law]

    def _refined(self, record: np.void, near: FittedStarts) -> FittedStarts:
        """Fit each glide's start by Gauss-Newton: first steps use the derivatives of `near`, later ones the law's own,
        until all steps are small."""
        starts, by_start = near.starts.copy(), near.by_start
        path = self._trace(record, starts)
        for step in range(SLIDING.start_steps):
            own = step >= SLIDING.start_steps_near
            if own:
                by_start = self._derivatives(record, starts, path)
            whitened = self.errors.white(by_start[:, :2])
            change = self._start_changes(whitened, (self.data.place - path[:, :2])[:, :, None])[:, :, 0]
            starts[:, :4] += change
            path = self._trace(record, starts)
            if own and np.all(np.abs(change) < SLIDING.start_converged * STEP):
                break
        return FittedStarts(starts, path, by_start)

    def _derivatives(self, record: np.void, starts: np.ndarray, path: np.ndarray) -> np.ndarray:
        """Derivatives (n, 4, 4) of a path (n, 4) by the place and velocity of its `starts` (g, 5)."""
        found = np.empty((len(path), 4, 4))
        for k in range(4):
            moved = starts.copy()
            moved[:, k] += STEP[k]
            found[:, :, k] = (self._trace(record, moved) - path) / STEP[k]
        return found

    def _start_changes(self, whitened: np.ndarray, changes: np.ndarray) -> np.ndarray:
        """Changes (g, 4, k) of the fitted starts due to `changes` (n, 2, k) [m] of all measured places; `whitened`
        (n, 2, 4): derivatives of the places by the starts, whitened."""
        products = np.einsum("nai,nak->nik", whitened, self.errors.white(changes))
        right = np.add.reduceat(products, self.data.first[:-1], axis=0)
        return np.linalg.solve(self._normal(whitened), right)

    def _normal(self, j: np.ndarray) -> np.ndarray:
        """Normal matrices (g, 4, 4) of the starts from the whitened derivatives `j` (n, 2, 4), with a small ridge."""
        normal = np.add.reduceat(np.einsum("nai,naj->nij", j, j), self.data.first[:-1], axis=0)
        return normal + SLIDING.start_ridge * np.eye(4) * np.trace(normal, axis1=1, axis2=2)[:, None, None]

    @property
    def _size(self) -> np.ndarray:
        return np.array([self._common["length"], self._common["width"]])


def _kinds(velocity: np.ndarray) -> dict[str, np.ndarray]:
    """Kinds of glides by `velocity` (g, 2) at the start: below or above median speed, lengthwise or crosswise."""
    speed = np.hypot(*velocity.T)
    fast, along = speed > np.median(speed), np.abs(velocity[:, 0]) > np.abs(velocity[:, 1])
    return {"slow": ~fast, "fast": fast, "lengthwise": along, "crosswise": ~along}


def _first_guess(data: GlideData) -> tuple[np.ndarray, np.ndarray]:
    """Starts (g, 5) from parabolas through the glides, without spin, and the speed (n,) [m/s] of each frame."""
    starts, speed = np.zeros((data.glides, 5)), np.zeros(len(data.t))
    for g, (a, b) in enumerate(zip(data.first[:-1], data.first[1:], strict=True)):
        u = data.t[a:b] - data.t[a]
        fit = np.polyfit(u, data.place[a:b], 2)
        starts[g, :2], starts[g, 2:4] = fit[2], fit[1]
        speed[a:b] = np.linalg.norm(fit[1] + 2.0 * fit[0] * u[:, None], axis=1)
    return starts, speed
