"""Wall contacts as an estimation problem: the velocity after each, predicted by the simulator's `rebound`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from puckpilot_env.kernel import kernel
from puckpilot_env.physics.contacts import bounce
from puckpilot_env.physics.contacts.rebound import rebound
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.problem import DesignMatrix
from sim2real.diagnose.regimes.contact.problem import ContactProblem
from sim2real.diagnose.regimes.contact.tuned import CONTACT
from sim2real.diagnose.regimes.wall.candidates import wall_design_matrix
from sim2real.diagnose.regimes.wall.data import KINDS, WallContacts
from sim2real.diagnose.regimes.wall.tuned import WALL
from sim2real.statistics.whitening import whitened


@kernel
def _predict_contacts(p, kind, normal, t, place, spin_chain, before, spin, pucks, after):
    """Write to `after` (n, 2) the velocities [m/s] after contacts in order of time; chains begin with `spin`."""
    puck = pucks[0]
    for i in range(len(kind)):
        if i == 0 or spin_chain[i] != spin_chain[i - 1]:
            puck.spin = spin
        else:
            puck.spin *= np.exp(-p.spin_decay * (t[i] - t[i - 1]))
        puck.x, puck.y = place[i, 0], place[i, 1]
        puck.vx, puck.vy = before[i, 0], before[i, 1]
        rebound(puck, p, t[i], kind[i], normal[i, 0], normal[i, 1])
        after[i, 0], after[i, 1] = puck.vx, puck.vy


class WallProblem(ContactProblem[WallContacts]):
    """Contacts with walls and posts: the velocity after each along the normal and the tangent."""

    regime = "wall"
    base: tuple[str, ...] = ("wall_restitution",)
    first_fitted: tuple[str, ...] = base
    each = 2
    unit_name = "wall contacts"

    def __init__(
        self, data: WallContacts, clusters: int, common: Mapping[str, float], scatter: tuple[float, float] = (0.0, 0.0)
    ) -> None:
        """See `ContactProblem`; `scatter`: standard deviation between contacts of the velocity after, along the normal
        and the tangent, as shares of the closing speed."""
        super().__init__(data, clusters, common)
        self.scatter = np.array(scatter)
        self._covariance, by_before = self._noise(self._record({}))
        self._set_noise(self._covariance, by_before)
        noise = np.trace(data.velocity_covariance.sum(axis=1), axis1=1, axis2=2) + (self._scatter_std**2).sum(axis=1)
        self.noise_m = CONTACT.flight_time * float(np.sqrt(noise.mean() / 2)) if len(data) else 0.0

    def with_scatter(self, scatter: tuple[float, float]) -> WallProblem:
        """A copy with another scatter."""
        return WallProblem(self.data, self.clusters, self._common, scatter)

    @property
    def sensor_variance(self) -> np.ndarray:
        """Variance (n, 2) [m^2/s^2] of the normal and tangential residuals without scatter."""
        return np.diagonal(self._covariance, axis1=1, axis2=2) - self._scatter_std**2

    @property
    def _scatter_std(self) -> np.ndarray:
        return self.scatter * self.data.closing_speed[:, None]

    @property
    def size(self) -> tuple[float, float]:
        """Length and width of the table [m]."""
        return self._common["length"], self._common["width"]

    @property
    def observed(self) -> np.ndarray:
        """Velocity after (n, 2) [m/s] along the normal and the tangent."""
        return self.data.components(self.data.velocity_after)

    def predicted(self, values: Mapping[str, float]) -> np.ndarray:
        """Velocity after (n, 2) [m/s] along the normal and the tangent, under a law."""
        return self.data.components(self._velocity_after(self._record(values), self.data.velocity_before))

    def with_common_noise(self, values: Mapping[str, float], predicted: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """See `ContactProblem.with_common_noise`."""
        rows, common_errors = (self._with_spin_noise(values, predicted, each) for each in (rows, self._common_errors))
        return whitened(common_errors, rows)

    def _with_spin_noise(self, values: Mapping[str, float], predicted: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Whiten `rows` (2 n, k) also for the spin at the start of each chain, if there is friction."""
        if values.get("wall_mu", 0.0) <= 0.0 or not len(self.data):
            return rows
        d, record = self.data, self._record(values)
        spun = d.components(self._velocity_after(record, d.velocity_before, WALL.spin_step))
        by_spin = self.whitened((spun - predicted) / WALL.spin_step)
        spin_std = np.where(d.spin_unknown, WALL.unknown_spin, WALL.launch_spin)
        rows = self._with_tangential_noise(values, rows)
        by_spin = self._with_tangential_noise(values, by_spin[:, None])[:, 0]
        for chain in np.unique(d.spin_chain):
            here = np.repeat(d.spin_chain == chain, 2)
            by_start = by_spin[here] * spin_std[d.spin_chain == chain][0]
            if by_start @ by_start > 1e-12:
                rows[here] = whitened(by_start[:, None], rows[here])
        return rows

    def widening(self, values: Mapping[str, float], others: Mapping[str, float]) -> float:
        """Half of the difference [m] between two laws in how much the distance of two opposite walls changes from one
        end to the other; of the pair for which it is larger. A turned or sheared map turns both alike: 0."""
        changes = [0.0]
        for first, second, along in (("x0", "x1", "width"), ("y0", "y1", "length")):
            if all((self.data.kind == KINDS[wall]).sum() >= WALL.fewest_of_wall for wall in (first, second)):
                angle, other = (
                    one.get(f"wall_angle_{first}", 0.0) - one.get(f"wall_angle_{second}", 0.0)
                    for one in (values, others)
                )
                changes.append(0.5 * abs(angle - other) * self._common[along])
        return max(changes)

    def _with_tangential_noise(self, values: Mapping[str, float], rows: np.ndarray) -> np.ndarray:
        """Whiten `rows` (2 n, k) for the tangential noise of each contact whose spin or normal is unknown; the largest
        effect of friction bounds it. Whitened normals have a share in it: the noise of both is correlated."""
        d = self.data
        unknown = d.kind == bounce.POST
        if not self.scatter.any():  # a scatter includes the effect of unobserved spins
            unknown |= d.spin_unknown
        reach = unknown * values["wall_mu"] * (1.0 + values["wall_restitution"]) * d.closing_speed
        by_noise = self._whitening[:, :, 1] * reach[:, None]
        size = np.maximum((by_noise**2).sum(axis=1), 1e-12)
        by_noise *= np.sqrt((1.0 - 1.0 / np.sqrt(1.0 + size)) / size)[:, None]
        pairs = rows.reshape(len(d), 2, -1)
        along = np.einsum("ni,nik->nk", by_noise, pairs)
        return (pairs - by_noise[:, :, None] * along[:, None]).reshape(rows.shape)

    def columns(
        self, values: Mapping[str, float], free: Sequence[str], use: np.ndarray | None, only: Sequence[Law] = ()
    ) -> DesignMatrix:
        """See `Problem.columns`."""
        return wall_design_matrix(self, values, free, use, only)

    def _velocity_after(self, record: np.void, before: np.ndarray, spin: float = 0.0) -> np.ndarray:
        """Velocities after (n, 2) [m/s] in the table's frame, given those before (n, 2) and the chains' first spin."""
        d = self.data
        after = np.empty_like(before)
        _predict_contacts(record, d.kind, d.normal, d.t, d.place, d.spin_chain, before, spin, self._pucks, after)
        return after

    def _noise(self, record: np.void) -> tuple[np.ndarray, np.ndarray]:
        """Covariance (n, 2, 2) [m^2/s^2] of the velocity residuals at the parameters `record`, and the derivative
        (n, 2, 2) of the prediction by the velocity before."""
        d, step = self.data, CONTACT.velocity_step
        now = self._velocity_after(record, d.velocity_before)
        moved = [self._velocity_after(record, d.velocity_before + step * d.axes[:, k]) - now for k in range(2)]
        by_before = np.stack([d.components(each) / step for each in moved], axis=2)
        by_noise = by_before @ d.velocity_covariance[:, 0] @ by_before.transpose(0, 2, 1)
        covariance = d.velocity_covariance[:, 1] + by_noise
        size = np.linalg.norm(d.velocity_before, axis=1) + np.linalg.norm(d.velocity_after, axis=1)
        covariance += np.eye(2) * ((d.normal_std * size) ** 2)[:, None, None]
        return covariance + np.eye(2) * self._scatter_std[:, None] ** 2, by_before
