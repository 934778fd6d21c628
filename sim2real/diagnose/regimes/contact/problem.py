"""Contacts as an estimation problem: whitened residuals of the velocity after each contact given the one before."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Generic

import numpy as np

from puckpilot_env.parameters import BY_NAME
from puckpilot_env.physics.advance import PUCK
from sim2real.diagnose.engine.problem import Residuals, Units, record_of
from sim2real.diagnose.regimes.contact.data import AnyContacts, Contacts
from sim2real.diagnose.regimes.contact.tuned import CONTACT


class ContactProblem(ABC, Generic[AnyContacts]):
    """Contacts of one kind with `each` residuals per contact; `unit_name` names them in advice to the user.

    Parameters that are missing from `values` have their defaults.
    """

    base: tuple[str, ...]
    each: int
    unit_name: str
    place_error_m = 0.0  # included in the velocities' errors, which come from the glides

    def __init__(self, data: AnyContacts, clusters: int, common: Mapping[str, float]) -> None:
        """`clusters`: number of launches in the recordings; `common`: the table's sizes and the glide law."""
        self.data, self.clusters, self._common = data, clusters, dict(common)
        self._pucks = np.zeros(1, PUCK)
        self.units = Units(data.cluster, np.full(len(data), float(self.each)), self.unit_name, _kinds(data))
        self.freedom = self.each * np.bincount(data.cluster, minlength=clusters).astype(float)

    def _set_noise(self, covariance: np.ndarray, by_before: np.ndarray) -> None:
        """Set the `covariance` (n, each, each) [m^2/s^2] of the velocity residuals (observed minus predicted).

        `by_before` (n, each, 2): derivative of the prediction by the velocity before.
        """
        value, vector = np.linalg.eigh(covariance)
        roots = np.sqrt(np.maximum(value, CONTACT.least_variance))
        self._whitening = vector @ (vector.transpose(0, 2, 1) / roots[:, :, None])
        common_errors = -by_before @ self.data.common_errors[:, 0]
        common_errors[:, :2] += self.data.common_errors[:, 1]
        self._common_errors = self.whitened(common_errors)

    @property
    @abstractmethod
    def observed(self) -> np.ndarray:
        """The observed values (n, each) [m/s] of what `predicted` predicts."""

    @abstractmethod
    def predicted(self, values: Mapping[str, float]) -> np.ndarray:
        """Predicted velocities (n, each) [m/s] after each contact: along the normal, the tangent, and others."""

    @abstractmethod
    def with_common_noise(self, values: Mapping[str, float], predicted: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Whiten `rows` (each n, k) of residuals or columns for the noise that contacts share: common errors and spin.

        predicted: the result of `predicted` for `values`.
        """

    def with_recoil(self, values: Mapping[str, float], changes: np.ndarray) -> np.ndarray:
        """Changes (n, each, k) [m/s] of the whole prediction, from `changes` of the puck's velocity in it."""
        return changes

    def residuals(self, values: Mapping[str, float], free: Sequence[str], clusters: np.ndarray) -> Residuals:
        """See `Problem.residuals`: velocities after each contact, observed minus predicted."""
        predicted = self.predicted(values)
        columns = np.empty((len(self.data), self.each, len(free)))
        for k, name in enumerate(free):
            row = BY_NAME[name]
            at, step = values.get(name, row.default), CONTACT.parameter_step * (row.high - row.low)
            step = step if at + step < row.high else -step
            columns[:, :, k] = (self.predicted({**values, name: at + step}) - predicted) / step
        r, jacobian = self.whitened(self.observed - predicted), -self.whitened(columns)
        both = self.with_common_noise(values, predicted, np.concatenate([r[:, None], jacobian], axis=1))
        cluster, unit = np.repeat(self.data.cluster, self.each), self.unit_of_rows
        here = np.isin(cluster, clusters)
        return Residuals(both[here, 0], both[here, 1:], cluster[here], unit[here])

    @property
    def std(self) -> np.ndarray:
        """Standard deviation (n, each) [m/s] of observed minus predicted velocities."""
        inverse = np.linalg.inv(self._whitening)
        return np.sqrt(np.einsum("nij,nij->ni", inverse, inverse))

    @property
    def unit_of_rows(self) -> np.ndarray:
        """Index (each n,) of the contact of each residual."""
        return np.repeat(np.arange(len(self.data)), self.each)

    def whitened(self, velocities: np.ndarray) -> np.ndarray:
        """Velocities (n, each, …) [m/s] in units of their noise, as rows (each n, …)."""
        shape = velocities.shape
        flat = velocities.reshape(len(self.data), self.each, int(np.prod(shape[2:])))  # there may be none
        return np.einsum("nij,njk->nik", self._whitening, flat).reshape(self.each * len(self.data), *shape[2:])

    def _record(self, values: Mapping[str, float]) -> np.void:
        return record_of({**self._common, **values})


def _kinds(data: Contacts) -> dict[str, np.ndarray]:
    """Slow, fast, steep and flat contacts (n,) bool, each split at the median."""
    if not len(data):
        return {}
    fast, flat = (size > np.median(size) for size in (data.closing_speed, data.incidence_angle))
    return {"slow": ~fast, "fast": fast, "steep": ~flat, "flat": flat}
