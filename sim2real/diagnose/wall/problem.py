"""Bounces as a problem for the engine: the velocity after each, from the one before, by the simulator's own rebound."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from puckpilot_env.kernel import kernel
from puckpilot_env.physics import bounce
from puckpilot_env.physics.rebound import rebound
from sim2real.diagnose.contact_problem import FLIGHT, STEP, ContactProblem
from sim2real.diagnose.engine.noise import allowing_for
from sim2real.diagnose.problem import Columns
from sim2real.diagnose.wall.data import Bounces
from sim2real.diagnose.wall.laws import wall_columns

SPIN_STEP = 1e-3  # rad/s
UNKNOWN_SPIN, LAUNCH_SPIN = 30.0, 1.0  # rad/s, std of the spin after a contact that was not seen well, and of a launch


@kernel
def _rebounds(p, kind, normal, t, place, chain, before, spin, pucks, after):
    """Velocities after (n, 2) of bounces in order; each chain begins with `spin` [rad/s] and carries it on."""
    puck = pucks[0]
    for i in range(len(kind)):
        if i == 0 or chain[i] != chain[i - 1]:
            puck.spin = spin
        else:
            puck.spin *= np.exp(-p.spin_decay * (t[i] - t[i - 1]))
        puck.x, puck.y = place[i, 0], place[i, 1]
        puck.vx, puck.vy = before[i, 0], before[i, 1]
        rebound(puck, p, t[i], kind[i], normal[i, 0], normal[i, 1])
        after[i, 0], after[i, 1] = puck.vx, puck.vy


class WallProblem(ContactProblem[Bounces]):
    """Bounces off walls and posts: the velocity after each along the normal and the tangent."""

    regime = "wall"
    base: tuple[str, ...] = ("wall_restitution",)
    plain: tuple[str, ...] = base
    each = 2
    units_called = "bounces"

    def __init__(
        self, data: Bounces, clusters: int, common: Mapping[str, float], scatter: tuple[float, float] = (0.0, 0.0)
    ) -> None:
        """`scatter`: std by which no two bounces are alike, of the velocity after along the normal and the tangent, as
        shares of the closing speed. The rest as in `ContactProblem`."""
        super().__init__(data, clusters, common)
        self.scatter = np.array(scatter)
        self._covariance, by_before = self._noise(self._record({}))
        self._whiten_by(self._covariance, by_before)
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

    @property
    def observed(self) -> np.ndarray:
        """Velocity after (n, 2) [m/s] along the normal and the tangent."""
        return self.data.split(self.data.after)

    def predicted(self, values: Mapping[str, float]) -> np.ndarray:
        """Velocity after (n, 2) [m/s] along the normal and the tangent, under a law."""
        return self.data.split(self._after(self._record(values), self.data.before))

    def allowing(self, values: Mapping[str, float], now: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """See `ContactProblem.allowing`."""
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

    def columns(self, values: Mapping[str, float], free: Sequence[str], use: np.ndarray | None) -> Columns:
        """See `Problem.columns`."""
        return wall_columns(self, values, free)

    def _after(self, record: np.void, before: np.ndarray, spin: float = 0.0) -> np.ndarray:
        d = self.data
        after = np.empty_like(before)
        _rebounds(record, d.kind, d.normal, d.t, d.place, d.chain, before, spin, self._pucks, after)
        return after

    def _noise(self, record: np.void) -> tuple[np.ndarray, np.ndarray]:
        """Covariance (n, 2, 2) of velocity after less foretold, at the law `record`; and how the foretold changes with
        the velocity before (n, 2, 2)."""
        d = self.data
        now = self._after(record, d.before)
        by = np.stack(
            [d.split(self._after(record, d.before + STEP * d.axes[:, k]) - now) / STEP for k in range(2)], axis=2
        )
        covariance = d.spread[:, 1] + by @ d.spread[:, 0] @ by.transpose(0, 2, 1)
        size = np.linalg.norm(d.before, axis=1) + np.linalg.norm(d.after, axis=1)
        covariance += np.eye(2) * ((d.turn * size) ** 2)[:, None, None]
        return covariance + np.eye(2) * self._scattered[:, None] ** 2, by
