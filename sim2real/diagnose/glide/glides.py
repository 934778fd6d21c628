"""Glides under a law: their paths, each from a start that is fitted, and the residuals that are left of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from puckpilot_env.parameters import BY_NAME
from puckpilot_env.physics.advance import PUCK
from sim2real.diagnose.glide.data import GlideData
from sim2real.diagnose.glide.errors import Errors
from sim2real.diagnose.glide.families import SPEED_KNOTS, Motion
from sim2real.diagnose.glide.trace import bend, trace
from sim2real.diagnose.piecewise import spread_knots
from sim2real.diagnose.problem import Residuals, Units, record_of

ROUNDS = 3  # of Gauss-Newton at most, from the last law's starts, and again from a parabola's
STEP = np.array([1e-6, 1e-6, 1e-5, 1e-5])  # of a start: m, m/s


class Glides:
    """Free glides. `values` passed to its methods are parameters of the simulator by name; the rest have defaults."""

    regime = "glide"
    base: tuple[str, ...] = ("friction", "drag")
    plain: tuple[str, ...] = base

    def __init__(self, data: GlideData, values: Mapping[str, float]) -> None:
        """`values`: sizes of the table, and what else every law has in common."""
        self.data = data
        self.clusters = data.clusters
        self._common = dict(values)
        self.errors = Errors(data, self._size)
        self._guess, speed = _first_guess(data)
        self._starts = self._guess.copy()
        self._speeds = spread_knots(speed, SPEED_KNOTS)
        self._pucks = np.zeros(1, PUCK)
        self.units = Units(data.cluster, 2.0 * np.diff(data.first) - 4.0, "glides", _kinds(self._starts[:, 2:4]))
        self.freedom = np.bincount(data.cluster, self.units.freedom, data.clusters)
        self.noise_m = float(np.sqrt(np.mean(data.std**2)))
        self.place_error_m = max(data.place_std)

    def motion(self, path: np.ndarray) -> Motion:
        """A path (n, 4) as the families of smooth forces see it."""
        data = self.data
        since, launch = data.t - data.of_frame(data.since), data.of_frame(data.cluster)
        begun = np.full(data.clusters, np.inf)
        np.minimum.at(begun, launch, data.t)
        aged = data.t - begun[launch]
        return Motion(data.t, path[:, :2], path[:, 2:], since, launch.astype(float), aged, self._size, self._speeds)

    def residuals(self, values: Mapping[str, float], free: Sequence[str], clusters: np.ndarray) -> Residuals:
        """See `Problem.residuals`."""
        data = self.data
        record = self._record(values)
        path, by_start = self._fit_starts(record)
        columns = np.empty((len(data.t), 2, len(free)))
        other = np.empty_like(path)
        for k, name in enumerate(free):
            step = 1e-5 * max(BY_NAME[name].high - BY_NAME[name].low, 1e-3)
            now = values.get(name, BY_NAME[name].default)
            self._trace(self._record({**values, name: now + step}), self._starts, other)
            columns[:, :, k] = (other[:, :2] - path[:, :2]) / step
        r, jacobian = self.profiled(path, by_start, columns)
        cluster = np.repeat(data.of_frame(data.cluster), 2)
        here = np.isin(cluster, clusters)
        return Residuals(r[here], jacobian[here], cluster[here])

    def profiled(self, path, by_start, columns) -> tuple[np.ndarray, np.ndarray]:
        """Residuals (2n,) and columns (2n, k) in units of the noise, less what each glide's start can explain.

        `columns` (n, 2, k): how the predicted place moves with each parameter [m]; the result is d residual.
        """
        data, white = self.data, self.errors.white
        changes = [(data.place - path[:, :2])[:, :, None], -columns, self.errors.modes(path[:, :2])]
        rows = white(np.concatenate(changes, axis=2)).reshape(2 * len(data.t), -1)
        starts = white(by_start).reshape(len(rows), 4)
        for a, b in zip(2 * data.first[:-1], 2 * data.first[1:], strict=True):
            q = np.linalg.qr(starts[a:b])[0]
            rows[a:b] -= q @ (q.T @ rows[a:b])
        known = 1 + columns.shape[2]
        rows = self.errors.allowing(rows[:, known:], rows[:, :known])
        return rows[:, 0], rows[:, 1:]

    def linearised(self, values: Mapping[str, float]) -> tuple[np.ndarray, np.ndarray]:
        """The path (n, 4) under a law with the starts fitted, and its derivatives (n, 2, 4) by the starts."""
        return self._fit_starts(self._record(values))

    def bent(self, path: np.ndarray, values: Mapping[str, float], force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Displacements and their rates (n, 2, k) that small accelerations `force` (n, 2, k) make along a path."""
        moved, moving = np.empty_like(force), np.empty_like(force)
        data = self.data
        bend(
            data.first, data.t, path, values["friction"], values["drag"], np.ascontiguousarray(force), moved, moving
        )  # fmt: skip
        return moved, moving

    def _record(self, values: Mapping[str, float]) -> np.void:
        return record_of({**self._common, **values})

    def _trace(self, record: np.void, starts: np.ndarray, path: np.ndarray) -> None:
        trace(record, self.data.first, self.data.t, starts, self._pucks, path)

    def _fit_starts(self, record) -> tuple[np.ndarray, np.ndarray]:
        data = self.data
        path, other = np.empty((len(data.t), 4)), np.empty((len(data.t), 4))
        by_start = np.empty((len(data.t), 2, 4))
        for tried in range(2 * ROUNDS):
            self._trace(record, self._starts, path)
            for k in range(4):
                moved = self._starts.copy()
                moved[:, k] += STEP[k]
                self._trace(record, moved, other)
                by_start[:, :, k] = (other[:, :2] - path[:, :2]) / STEP[k]
            change = self._answers(by_start, (data.place - path[:, :2])[:, :, None])[:, :, 0]
            self._starts[:, :4] += change
            astray = ~np.all(np.abs(change) < 10 * STEP, axis=1)
            if not astray.any():
                break
            if tried == ROUNDS - 1:  # a law that was tried before may have led these too far away
                self._starts[astray] = self._guess[astray]
        self._trace(record, self._starts, path)
        return path, by_start

    def _answers(self, by_start: np.ndarray, changes: np.ndarray) -> np.ndarray:
        """By how much (g, 4, k) the starts move where all places change (n, 2, k), by least squares."""
        white = self.errors.white
        by, moved = white(by_start), white(changes)
        right = np.add.reduceat(np.einsum("nai,nak->nik", by, moved), self.data.first[:-1], axis=0)
        return np.linalg.solve(self._normal(by), right)

    def _normal(self, j: np.ndarray) -> np.ndarray:
        """Normal matrices (g, 4, 4) of the starts, from derivatives by them (n, 2, 4) in units of white noise; a touch
        is added to what no frame tells."""
        normal = np.add.reduceat(np.einsum("nai,naj->nij", j, j), self.data.first[:-1], axis=0)
        return normal + 1e-9 * np.eye(4) * np.trace(normal, axis1=1, axis2=2)[:, None, None]

    @property
    def _size(self) -> np.ndarray:
        return np.array([self._common["length"], self._common["width"]])


def _kinds(velocity: np.ndarray) -> dict[str, np.ndarray]:
    """Slow and fast glides, by the median of their speeds at the start; those along the table and across it."""
    speed = np.hypot(*velocity.T)
    fast, along = speed > np.median(speed), np.abs(velocity[:, 0]) > np.abs(velocity[:, 1])
    return {"slow": ~fast, "fast": fast, "lengthwise": along, "crosswise": ~along}


def _first_guess(data: GlideData) -> tuple[np.ndarray, np.ndarray]:
    """Starts (g, 5) of parabolas through the glides, and the speed (n,) [m/s] of each frame along them."""
    starts, speed = np.zeros((data.glides, 5)), np.zeros(len(data.t))
    for g, (a, b) in enumerate(zip(data.first[:-1], data.first[1:], strict=True)):
        u = data.t[a:b] - data.t[a]
        fit = np.polyfit(u, data.place[a:b], 2)
        starts[g, :2], starts[g, 2:4] = fit[2], fit[1]
        speed[a:b] = np.linalg.norm(fit[1] + 2.0 * fit[0] * u[:, None], axis=1)
    return starts, speed
