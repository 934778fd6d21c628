"""Blows as a problem for the engine: the puck's velocity after each and the mallet's recoil, by the simulator's strike.

The puck alone shows (1 + e) / (1 + give); that the mallet is knocked back by give times the puck's change of velocity
tells the two apart. Walls are taken to leave the puck's spin alone, so that it is carried from blow to blow.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from puckpilot_env.kernel import kernel
from puckpilot_env.parameters import BY_NAME
from puckpilot_env.physics.advance import PUCK
from puckpilot_env.physics.rebound import strike
from sim2real.diagnose.engine.noise import allowing_for
from sim2real.diagnose.mallet.data import Blows
from sim2real.diagnose.mallet.laws import mallet_columns
from sim2real.diagnose.problem import Columns, Residuals, Units, record_of

FLIGHT = 0.1  # s; an error of a velocity is told as that of the place so much later
STEP = 1e-5  # m/s


@kernel
def _strikes(p, normal, t, chain, driven, before, pucks, after):
    """Velocities after (n, 2) of blows in order, by a mallet of velocity `driven`; a chain begins without spin."""
    puck = pucks[0]
    for i in range(len(normal)):
        if i == 0 or chain[i] != chain[i - 1]:
            puck.spin = 0.0
        else:
            puck.spin *= np.exp(-p.spin_decay * (t[i] - t[i - 1]))
        puck.vx, puck.vy = before[i, 0], before[i, 1]
        strike(puck, p, driven[i, 0], driven[i, 1], normal[i, 0], normal[i, 1])
        after[i, 0], after[i, 1] = puck.vx, puck.vy


class MalletProblem:
    """Blows of the robot's mallet, three residuals each. Parameters that `values` leave out have their defaults."""

    regime = "mallet"
    base: tuple[str, ...] = ("mallet_restitution",)
    plain: tuple[str, ...] = base

    def __init__(self, data: Blows, clusters: int, common: Mapping[str, float]) -> None:
        """`clusters`: how many launches the recordings have; `common`: sizes of the table."""
        self.data, self.clusters, self._common = data, clusters, dict(common)
        self._pucks = np.zeros(1, PUCK)
        self.units = Units(data.cluster, np.full(len(data), 3.0))
        self.freedom = 3.0 * np.bincount(data.cluster, minlength=clusters)
        self._whiten, by_before = self._whitening()
        drift = -by_before @ data.drift[:, 0]
        drift[:, :2] += data.drift[:, 1]
        self._drift = self.whitened(drift)
        spread = data.spread.sum(axis=1)
        self.noise_m = FLIGHT * float(np.sqrt(np.trace(spread, axis1=1, axis2=2).mean() / 2)) if len(data) else 0.0

    def residuals(self, values: Mapping[str, float], free: Sequence[str], clusters: np.ndarray) -> Residuals:
        """See `Problem.residuals`: normal and tangential velocity after each blow, and the mallet's step, seen less
        foretold."""
        now = self.predicted(values)
        columns = np.empty((len(self.data), 3, len(free)))
        for k, name in enumerate(free):
            row = BY_NAME[name]
            at, step = values.get(name, row.default), 1e-5 * (row.high - row.low)
            step = step if at + step < row.high else -step
            columns[:, :, k] = (self.predicted({**values, name: at + step}) - now) / step
        seen = np.concatenate([self.data.split(self.data.after), self.data.step[:, None]], axis=1)
        r, jacobian = self.whitened(seen - now), -self.whitened(columns)
        both = self.allowing(values, np.concatenate([r[:, None], jacobian], axis=1))
        cluster = np.repeat(self.data.cluster, 3)
        here = np.isin(cluster, clusters)
        unit = np.repeat(np.arange(len(self.data)), 3)
        return Residuals(both[here, 0], both[here, 1:], cluster[here], unit[here])

    def predicted(self, values: Mapping[str, float]) -> np.ndarray:
        """Velocity after along the normal and the tangent, and the mallet's step along the normal: (n, 3) [m/s]."""
        return self._predicted(self._record(values), self.data.before, self.data.driven)

    def allowing(self, values: Mapping[str, float], rows: np.ndarray) -> np.ndarray:
        """Residuals or columns (3n, k) with further noise: the glides' law, common to all blows, and along the tangent
        where the spin is unknown, up to what friction can do."""
        d = self.data
        e = values.get("mallet_restitution", BY_NAME["mallet_restitution"].default)
        reach = values.get("mallet_mu", 0.0) * (1.0 + e) * d.closing
        blur = np.ones((len(d), 3, 1))
        blur[:, 1, 0] = np.where(d.lost, np.hypot(1.0, reach * self._whiten[:, 1, 1]), 1.0)
        blur = blur.reshape(-1, 1)
        return allowing_for(self._drift / blur, rows / blur)

    def whitened(self, velocities: np.ndarray) -> np.ndarray:
        """Velocities (n, 3, …) in units of their noise, as rows (3n, …)."""
        shape = velocities.shape
        flat = velocities.reshape(len(self.data), 3, -1)
        return np.einsum("nij,njk->nik", self._whiten, flat).reshape(3 * len(self.data), *shape[2:])

    def columns(self, values: Mapping[str, float], free: Sequence[str], use: np.ndarray | None) -> Columns:
        """See `Problem.columns`."""
        return mallet_columns(self, values, free)

    def _record(self, values: Mapping[str, float]) -> np.void:
        return record_of({**self._common, **values})

    def _predicted(self, record: np.void, before: np.ndarray, driven: np.ndarray) -> np.ndarray:
        after = np.empty_like(before)
        _strikes(record, self.data.normal, self.data.t, self.data.chain, driven, before, self._pucks, after)
        change = self.data.split(after - before)[:, :1]
        return np.concatenate([self.data.split(after), -float(record["mallet_give"]) * change], axis=1)

    def _whitening(self) -> tuple[np.ndarray, np.ndarray]:
        """Inverse roots (n, 3, 3) of the covariance of what is seen less what the baseline foretells of it; and how the
        foretold changes with the velocity before (n, 3, 2)."""
        d, record = self.data, self._record({})
        axes = np.stack([d.normal, np.stack([-d.normal[:, 1], d.normal[:, 0]], axis=1)], axis=1)
        now = self._predicted(record, d.before, d.driven)
        moved = [(self._predicted(record, d.before + STEP * axes[:, k], d.driven) - now) / STEP for k in range(2)]
        by_before = np.stack(moved, axis=2)
        moved = [(self._predicted(record, d.before, d.driven + STEP * axes[:, k]) - now) / STEP for k in range(2)]
        by_swing = np.concatenate([np.stack(moved, axis=2), np.zeros((len(d), 3, 1))], axis=2)
        by_swing[:, 2, 2] = -1.0
        covariance = by_before @ d.spread[:, 0] @ by_before.transpose(0, 2, 1)
        covariance += by_swing @ d.swing @ by_swing.transpose(0, 2, 1)
        covariance[:, :2, :2] += d.spread[:, 1]
        size = np.linalg.norm(d.after - d.before, axis=1)
        covariance[:, :2, :2] += np.eye(2) * ((d.turn * size) ** 2)[:, None, None]
        value, vector = np.linalg.eigh(covariance)
        return vector @ (vector.transpose(0, 2, 1) / np.sqrt(np.maximum(value, 1e-12))[:, :, None]), by_before
