"""Mallet contacts as an estimation problem: the simulator's `strike` predicts puck velocity and mallet recoil.

The puck alone determines (1 + e) / (1 + give); the mallet's recoil, give times the puck's change of velocity, separates
the two. Walls are assumed not to change the puck's spin, so that it carries over from one contact to the next.

A moving mallet is seen where it was a little earlier or later, for its clock and the camera's agree to a fraction of a
millisecond only: at 2 m/s, 0.3 ms turn a contact's normal by 8 mrad, ten times its noise; at 100 m/s^2 they change the
mallet's velocity by 0.03 m/s. This error is common to all contacts of a recording.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from puckpilot_env.kernel import kernel
from puckpilot_env.parameters import BY_NAME
from puckpilot_env.physics.contacts.rebound import strike
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.problem import DesignMatrix
from sim2real.diagnose.regimes.contact.problem import ContactProblem
from sim2real.diagnose.regimes.contact.tuned import CONTACT
from sim2real.diagnose.regimes.mallet.candidates import mallet_design_matrix
from sim2real.diagnose.regimes.mallet.data import MalletContacts
from sim2real.diagnose.regimes.mallet.tuned import MALLET
from sim2real.statistics.whitening import whitened


@kernel
def _predict_contacts(p, normal, t, place, spin_chain, mallet_velocity, before, pucks, after):
    """Write to `after` (n, 2) the velocities [m/s] after contacts in order of time; each chain begins without spin."""
    puck = pucks[0]
    for i in range(len(normal)):
        if i == 0 or spin_chain[i] != spin_chain[i - 1]:
            puck.spin = 0.0
        else:
            puck.spin *= np.exp(-p.spin_decay * (t[i] - t[i - 1]))
        puck.x, puck.y = place[i, 0], place[i, 1]
        puck.vx, puck.vy = before[i, 0], before[i, 1]
        strike(puck, p, t[i], mallet_velocity[i, 0], mallet_velocity[i, 1], normal[i, 0], normal[i, 1])
        after[i, 0], after[i, 1] = puck.vx, puck.vy


class MalletProblem(ContactProblem[MalletContacts]):
    """Contacts with the robot's mallet: the puck's velocity after each, along the normal and the tangent, and the
    step of the mallet's velocity."""

    regime = "mallet"
    base: tuple[str, ...] = ("mallet_restitution",)
    first_fitted: tuple[str, ...] = base
    each = 3
    unit_name = "mallet contacts"

    def __init__(self, data: MalletContacts, clusters: int, common: Mapping[str, float], left_out: int = 0) -> None:
        """See `ContactProblem`; `left_out`: number of contacts whose measurement went wrong."""
        super().__init__(data, clusters, common)
        self.left_out = left_out
        record = self._record({})
        self._set_noise(*self._noise(record))
        clocks = self.whitened(self._clock_errors(record))
        self._common_errors = np.concatenate([self._common_errors, clocks], axis=1)
        covariance = data.velocity_covariance.sum(axis=1)
        noise = np.trace(covariance, axis1=1, axis2=2)
        self.noise_m = CONTACT.flight_time * float(np.sqrt(noise.mean() / 2)) if len(data) else 0.0

    def with_contacts(self, data: MalletContacts, left_out: int) -> MalletProblem:
        """The same for these contacts alone."""
        return MalletProblem(data, self.clusters, self._common, left_out)

    @property
    def common_errors(self) -> np.ndarray:
        """Changes (3 n, k) of the residuals, in units of their noise, by each standard normal error that contacts
        share: of the law of the glides, the map, and each recording's clocks."""
        return self._common_errors

    @property
    def observed(self) -> np.ndarray:
        """Puck velocity after, along the normal and the tangent, and the mallet's step: (n, 3) [m/s]."""
        return np.concatenate([self.data.components(self.data.velocity_after), self.data.mallet_step[:, None]], axis=1)

    def predicted(self, values: Mapping[str, float]) -> np.ndarray:
        """Predicted puck velocity after, along the normal and the tangent, and the mallet's step: (n, 3) [m/s]."""
        d = self.data
        return self._predicted(self._record(values), d.velocity_before, d.mallet_velocity, d.normal)

    def with_common_noise(self, values: Mapping[str, float], predicted: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """See `ContactProblem.with_common_noise`: if the spin is unknown, the noise along the tangent grows by the
        largest effect of friction."""
        d = self.data
        e = values.get("mallet_restitution", BY_NAME["mallet_restitution"].default)
        reach = values.get("mallet_mu", 0.0) * (1.0 + e) * d.closing_speed
        growth = np.ones((len(d), 3, 1))
        growth[:, 1, 0] = np.where(d.spin_unknown, np.hypot(1.0, reach * self._whitening[:, 1, 1]), 1.0)
        growth = growth.reshape(-1, 1)
        return whitened(self._common_errors / growth, rows / growth)

    def with_recoil(self, values: Mapping[str, float], changes: np.ndarray) -> np.ndarray:
        """See `ContactProblem.with_recoil`: the mallet recoils in proportion to the puck's change along the normal."""
        recoiling = changes.copy()
        recoiling[:, 2] = -values.get("mallet_give", 0.0) * changes[:, 0]
        return recoiling

    def columns(
        self, values: Mapping[str, float], free: Sequence[str], use: np.ndarray | None, only: Sequence[Law] = ()
    ) -> DesignMatrix:
        """See `Problem.columns`."""
        return mallet_design_matrix(self, values, free, only)

    def _predicted(
        self, record: np.void, before: np.ndarray, mallet_velocity: np.ndarray, normal: np.ndarray
    ) -> np.ndarray:
        """See `predicted`, from velocities (n, 2) [m/s] of the puck and the mallet before, and the normals (n, 2) of
        the contacts."""
        after = np.empty_like(before)
        d = self.data
        _predict_contacts(record, normal, d.t, d.place, d.spin_chain, mallet_velocity, before, self._pucks, after)
        change = d.components(after - before)[:, :1]
        return np.concatenate([d.components(after), -float(record["mallet_give"]) * change], axis=1)

    def _noise(self, record: np.void) -> tuple[np.ndarray, np.ndarray]:
        """Covariance (n, 3, 3) [m^2/s^2] of observed minus predicted values at the parameters `record`, and the
        derivative (n, 3, 2) of the prediction by the velocity before."""
        d, step = self.data, CONTACT.velocity_step
        before, mallet = d.velocity_before, d.mallet_velocity
        now = self._predicted(record, before, mallet, d.normal)
        moved = [
            (self._predicted(record, before + step * d.axes[:, k], mallet, d.normal) - now) / step for k in range(2)
        ]
        by_before = np.stack(moved, axis=2)
        moved = [
            (self._predicted(record, before, mallet + step * d.axes[:, k], d.normal) - now) / step for k in range(2)
        ]
        by_mallet = np.concatenate([np.stack(moved, axis=2), np.zeros((len(d), 3, 1))], axis=2)
        by_mallet[:, 2, 2] = -1.0
        covariance = by_before @ d.velocity_covariance[:, 0] @ by_before.transpose(0, 2, 1)
        covariance += by_mallet @ d.mallet_covariance @ by_mallet.transpose(0, 2, 1)
        covariance[:, :2, :2] += d.velocity_covariance[:, 1]
        size = np.linalg.norm(d.velocity_after - d.velocity_before, axis=1)
        covariance[:, :2, :2] += np.eye(2) * ((d.normal_std * size) ** 2)[:, None, None]
        return covariance, by_before

    def _clock_errors(self, record: np.void) -> np.ndarray:
        """The changes (n, 3, recordings) [m/s] of the observed minus the predicted values by one standard deviation of
        the error of each recording's clocks."""
        d, step = self.data, MALLET.clock_step
        turned = d.normal + step * d.turning[:, None] * d.axes[:, 1]
        faster = d.mallet_velocity + step * d.mallet_acceleration
        now = self._predicted(record, d.velocity_before, d.mallet_velocity, d.normal)
        changes = (now - self._predicted(record, d.velocity_before, faster, turned)) * (MALLET.clock_error / step)
        return np.where(d.recording[:, None, None] == np.unique(d.recording), changes[:, :, None], 0.0)
