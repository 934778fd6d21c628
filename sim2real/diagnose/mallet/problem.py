"""Blows as a problem for the engine: the puck's velocity after each and the mallet's recoil, by the simulator's strike.

The puck alone shows (1 + e) / (1 + give); that the mallet is knocked back by give times the puck's change of velocity
tells the two apart. Walls are taken to leave the puck's spin alone, so that it is carried from blow to blow.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from puckpilot_env.kernel import kernel
from puckpilot_env.parameters import BY_NAME
from puckpilot_env.physics.rebound import strike
from sim2real.diagnose.contact_problem import FLIGHT, STEP, ContactProblem
from sim2real.diagnose.engine.noise import allowing_for
from sim2real.diagnose.mallet.data import Blows
from sim2real.diagnose.mallet.laws import mallet_columns
from sim2real.diagnose.problem import Columns


@kernel
def _strikes(p, normal, t, place, chain, driven, before, pucks, after):
    """Velocities after (n, 2) of blows in order, by a mallet of velocity `driven`; a chain begins without spin."""
    puck = pucks[0]
    for i in range(len(normal)):
        if i == 0 or chain[i] != chain[i - 1]:
            puck.spin = 0.0
        else:
            puck.spin *= np.exp(-p.spin_decay * (t[i] - t[i - 1]))
        puck.x, puck.y = place[i, 0], place[i, 1]
        puck.vx, puck.vy = before[i, 0], before[i, 1]
        strike(puck, p, t[i], driven[i, 0], driven[i, 1], normal[i, 0], normal[i, 1])
        after[i, 0], after[i, 1] = puck.vx, puck.vy


class MalletProblem(ContactProblem[Blows]):
    """Blows of the robot's mallet: the velocity after each along the normal and the tangent, and the mallet's step."""

    regime = "mallet"
    base: tuple[str, ...] = ("mallet_restitution",)
    plain: tuple[str, ...] = base
    each = 3
    units_called = "blows"

    def __init__(self, data: Blows, clusters: int, common: Mapping[str, float]) -> None:
        """See `ContactProblem`."""
        super().__init__(data, clusters, common)
        self._whiten_by(*self._noise(self._record({})))
        spread = data.spread.sum(axis=1)
        self.noise_m = FLIGHT * float(np.sqrt(np.trace(spread, axis1=1, axis2=2).mean() / 2)) if len(data) else 0.0

    @property
    def observed(self) -> np.ndarray:
        """Velocity after along the normal and the tangent, and the mallet's step: (n, 3) [m/s]."""
        return np.concatenate([self.data.split(self.data.after), self.data.step[:, None]], axis=1)

    def predicted(self, values: Mapping[str, float]) -> np.ndarray:
        """Velocity after along the normal and the tangent, and the mallet's step along the normal: (n, 3) [m/s]."""
        return self._predicted(self._record(values), self.data.before, self.data.driven)

    def allowing(self, values: Mapping[str, float], now: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """See `ContactProblem.allowing`: along the tangent, where the spin is unknown, up to what friction can do."""
        d = self.data
        e = values.get("mallet_restitution", BY_NAME["mallet_restitution"].default)
        reach = values.get("mallet_mu", 0.0) * (1.0 + e) * d.closing
        blur = np.ones((len(d), 3, 1))
        blur[:, 1, 0] = np.where(d.lost, np.hypot(1.0, reach * self._whiten[:, 1, 1]), 1.0)
        blur = blur.reshape(-1, 1)
        return allowing_for(self._drift / blur, rows / blur)

    def with_recoil(self, values: Mapping[str, float], impulses: np.ndarray) -> np.ndarray:
        """See `ContactProblem.with_recoil`: the mallet gives way to the puck's change along the normal."""
        recoiling = impulses.copy()
        recoiling[:, 2] = -values.get("mallet_give", 0.0) * impulses[:, 0]
        return recoiling

    def columns(self, values: Mapping[str, float], free: Sequence[str], use: np.ndarray | None) -> Columns:
        """See `Problem.columns`."""
        return mallet_columns(self, values, free)

    def _predicted(self, record: np.void, before: np.ndarray, driven: np.ndarray) -> np.ndarray:
        after = np.empty_like(before)
        d = self.data
        _strikes(record, d.normal, d.t, d.place, d.chain, driven, before, self._pucks, after)
        change = d.split(after - before)[:, :1]
        return np.concatenate([d.split(after), -float(record["mallet_give"]) * change], axis=1)

    def _noise(self, record: np.void) -> tuple[np.ndarray, np.ndarray]:
        """Covariance (n, 3, 3) of what is seen less what a law foretells of it; and how the foretold changes with the
        velocity before (n, 3, 2)."""
        d = self.data
        now = self._predicted(record, d.before, d.driven)
        moved = [(self._predicted(record, d.before + STEP * d.axes[:, k], d.driven) - now) / STEP for k in range(2)]
        by_before = np.stack(moved, axis=2)
        moved = [(self._predicted(record, d.before, d.driven + STEP * d.axes[:, k]) - now) / STEP for k in range(2)]
        by_swing = np.concatenate([np.stack(moved, axis=2), np.zeros((len(d), 3, 1))], axis=2)
        by_swing[:, 2, 2] = -1.0
        covariance = by_before @ d.spread[:, 0] @ by_before.transpose(0, 2, 1)
        covariance += by_swing @ d.swing @ by_swing.transpose(0, 2, 1)
        covariance[:, :2, :2] += d.spread[:, 1]
        size = np.linalg.norm(d.after - d.before, axis=1)
        covariance[:, :2, :2] += np.eye(2) * ((d.turn * size) ** 2)[:, None, None]
        return covariance, by_before
