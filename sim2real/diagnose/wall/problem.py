"""Bounces as a problem for the engine: the velocity after each, from the one before, by the simulator's own rebound."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from puckpilot_env.kernel import kernel
from puckpilot_env.parameters import BY_NAME
from puckpilot_env.physics import bounce
from puckpilot_env.physics.advance import PUCK
from puckpilot_env.physics.rebound import rebound
from sim2real.diagnose.engine.noise import allowing_for
from sim2real.diagnose.problem import Columns, Residuals, Units, record_of
from sim2real.diagnose.wall.data import Bounces
from sim2real.diagnose.wall.laws import wall_columns

FLIGHT = 0.1  # s; an error of a velocity is told as that of the place so much later
STEP = 1e-5  # m/s
SPIN_STEP = 1e-3  # rad/s
UNKNOWN_SPIN, LAUNCH_SPIN = 30.0, 1.0  # rad/s, std of the spin after a contact that was not seen well, and of a launch


@kernel
def _rebounds(p, kind, normal, t, chain, before, spin, pucks, after):
    """Velocities after (n, 2) of bounces in order; each chain begins with `spin` [rad/s] and carries it on."""
    puck = pucks[0]
    for i in range(len(kind)):
        if i == 0 or chain[i] != chain[i - 1]:
            puck.spin = spin
        else:
            puck.spin *= np.exp(-p.spin_decay * (t[i] - t[i - 1]))
        puck.vx, puck.vy = before[i, 0], before[i, 1]
        rebound(puck, p, kind[i], normal[i, 0], normal[i, 1])
        after[i, 0], after[i, 1] = puck.vx, puck.vy


class WallProblem:
    """Bounces off walls and posts. Parameters that `values` leave out have their defaults."""

    regime = "wall"
    base: tuple[str, ...] = ("wall_restitution",)
    plain: tuple[str, ...] = base

    def __init__(
        self, data: Bounces, clusters: int, common: Mapping[str, float], scatter: tuple[float, float] = (0.0, 0.0)
    ) -> None:
        """`clusters`: how many launches the recording has; `common`: sizes of the table; `scatter`: std by which no two
        bounces are alike, of the velocity after along the normal and the tangent, as shares of the closing speed."""
        self.data, self.clusters, self.scatter, self._common = data, clusters, np.array(scatter), dict(common)
        self._pucks = np.zeros(1, PUCK)
        self.units = Units(data.cluster, np.full(len(data), 2.0))
        self.freedom = 2.0 * np.bincount(data.cluster, minlength=clusters)
        self._covariance, by_before = self._noise(self._record({}))
        value, vector = np.linalg.eigh(self._covariance)
        self._whiten = vector @ (vector.transpose(0, 2, 1) / np.sqrt(np.maximum(value, 1e-12))[:, :, None])
        drift = data.drift[:, 1] - by_before @ data.drift[:, 0]
        self._drift = self.whitened(drift)
        noise = np.trace(data.spread.sum(axis=1), axis1=1, axis2=2) + (self._scattered**2).sum(axis=1)
        self.noise_m = FLIGHT * float(np.sqrt(noise.mean() / 2)) if len(data) else 0.0

    def scattering(self, scatter: tuple[float, float]) -> WallProblem:
        """The same bounces with another scatter."""
        return WallProblem(self.data, self.clusters, self._common, scatter)

    @property
    def sensed(self) -> np.ndarray:
        """Variance (n, 2) [m^2/s^2] of the normal and the tangential residual without any scatter."""
        return np.diagonal(self._covariance, axis1=1, axis2=2) - self._scattered**2

    @property
    def _scattered(self) -> np.ndarray:
        return self.scatter * self.data.closing[:, None]

    @property
    def size(self) -> tuple[float, float]:
        """Length and width of the table [m]."""
        return self._common["length"], self._common["width"]

    def residuals(self, values: Mapping[str, float], free: Sequence[str], clusters: np.ndarray) -> Residuals:
        """See `Problem.residuals`: normal and tangential velocity after each bounce, seen less foretold."""
        now = self.predicted(values)
        columns = np.empty((len(self.data), 2, len(free)))
        for k, name in enumerate(free):
            row = BY_NAME[name]
            at = values.get(name, row.default)
            step = 1e-5 * (row.high - row.low) * (1.0 if at + 1e-5 * (row.high - row.low) < row.high else -1.0)
            columns[:, :, k] = (self.predicted({**values, name: at + step}) - now) / step
        r, jacobian = self.whitened(self.data.split(self.data.after) - now), -self.whitened(columns)
        both = self.allowing(values, now, np.concatenate([r[:, None], jacobian], axis=1))
        cluster = np.repeat(self.data.cluster, 2)
        here = np.isin(cluster, clusters)
        unit = np.repeat(np.arange(len(self.data)), 2)
        return Residuals(both[here, 0], both[here, 1:], cluster[here], unit[here])

    def predicted(self, values: Mapping[str, float]) -> np.ndarray:
        """Velocity after (n, 2) [m/s] along the normal and the tangent, under a law."""
        return self.data.split(self._after(self._record(values), self.data.before))

    def allowing(self, values: Mapping[str, float], now: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Residuals or columns (2n, k) with further noise: the glides' law, common to all bounces, and the spin.

        now: what the law foretells, as `predicted` gives it.
        """
        rows, drift = (self._allowing_for_spin(values, now, each) for each in (rows, self._drift))
        return allowing_for(drift, rows)

    def _allowing_for_spin(self, values: Mapping[str, float], now: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """The same with the spin at each chain's start, where there is friction."""
        if values.get("wall_mu", 0.0) <= 0.0 or not len(self.data):
            return rows
        d, record = self.data, self._record(values)
        by_spin = self.whitened((d.split(self._after(record, d.before, SPIN_STEP)) - now) / SPIN_STEP)
        prior = np.where(d.lost, UNKNOWN_SPIN, LAUNCH_SPIN)
        rows = rows.copy()
        rows[1::2] /= self._blur(values)[:, None]
        for chain in np.unique(d.chain):
            here = np.repeat(d.chain == chain, 2)
            s = by_spin[here] * prior[d.chain == chain][0]
            if s @ s > 1e-12:
                rows[here] = allowing_for(s[:, None], rows[here])
        return rows

    def _blur(self, values: Mapping[str, float]) -> np.ndarray:
        """By how much (n,) the tangential noise grows where spin or normal is not known: up to what friction can do."""
        d = self.data
        reach = values["wall_mu"] * (1.0 + values["wall_restitution"]) * d.closing
        unknown = d.kind == bounce.POST
        if not self.scatter.any():  # which holds what spins do that nobody saw
            unknown |= d.lost
        return np.where(unknown, np.hypot(1.0, reach * self._whiten[:, 1, 1]), 1.0)

    def whitened(self, velocities: np.ndarray) -> np.ndarray:
        """Velocities (n, 2, …) in units of their noise, as rows (2n, …)."""
        shape = velocities.shape
        flat = velocities.reshape(len(self.data), 2, -1)
        return np.einsum("nij,njk->nik", self._whiten, flat).reshape(2 * len(self.data), *shape[2:])

    def columns(self, values: Mapping[str, float], free: Sequence[str], use: np.ndarray | None) -> Columns:
        """See `Problem.columns`."""
        return wall_columns(self, values, free)

    def _record(self, values: Mapping[str, float]) -> np.void:
        return record_of({**self._common, **values})

    def _after(self, record: np.void, before: np.ndarray, spin: float = 0.0) -> np.ndarray:
        d = self.data
        after = np.empty_like(before)
        _rebounds(record, d.kind, d.normal, d.t, d.chain, before, spin, self._pucks, after)
        return after

    def _noise(self, record: np.void) -> tuple[np.ndarray, np.ndarray]:
        """Covariance (n, 2, 2) of velocity after less foretold, at the law `record`; and how the foretold changes with
        the velocity before (n, 2, 2)."""
        d = self.data
        axes = np.stack([d.normal, np.stack([-d.normal[:, 1], d.normal[:, 0]], axis=1)], axis=1)
        now = self._after(record, d.before)
        by = np.stack(
            [d.split(self._after(record, d.before + STEP * axes[:, k]) - now) / STEP for k in range(2)], axis=2
        )
        covariance = d.spread[:, 1] + by @ d.spread[:, 0] @ by.transpose(0, 2, 1)
        size = np.linalg.norm(d.before, axis=1) + np.linalg.norm(d.after, axis=1)
        covariance += np.eye(2) * ((d.turn * size) ** 2)[:, None, None]
        return covariance + np.eye(2) * self._scattered[:, None] ** 2, by
