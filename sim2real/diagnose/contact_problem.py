"""What bounces and blows have in common as problems for the engine: a few velocities after each contact, foretold from
those before it, in units of their noise."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Generic

import numpy as np

from puckpilot_env.parameters import BY_NAME
from puckpilot_env.physics.advance import PUCK
from sim2real.diagnose.contact_data import C, Contacts
from sim2real.diagnose.problem import Residuals, Units, record_of

FLIGHT = 0.1  # s; an error of a velocity is told as that of the place so much later
STEP = 1e-5  # m/s, of a velocity before, for derivatives by it
SHARE_STEP = 1e-5  # of a parameter's range, likewise
LEAST_VARIANCE = 1e-12  # m^2/s^2, of rounding: no velocity is known better


class ContactProblem(ABC, Generic[C]):
    """Contacts of one kind, `each` residuals of every one. Parameters that `values` leave out have their defaults."""

    base: tuple[str, ...]
    each: int
    units_called: str
    place_error_m = 0.0  # velocities are told by glides, which know it

    def __init__(self, data: C, clusters: int, common: Mapping[str, float]) -> None:
        """`clusters`: how many launches the recordings have; `common`: sizes of the table, and the glides' law."""
        self.data, self.clusters, self._common = data, clusters, dict(common)
        self._pucks = np.zeros(1, PUCK)
        self.units = Units(data.cluster, np.full(len(data), float(self.each)), self.units_called, _kinds(data))
        self.freedom = self.each * np.bincount(data.cluster, minlength=clusters).astype(float)

    def _whiten_by(self, covariance: np.ndarray, by_before: np.ndarray) -> None:
        """Take `covariance` (n, each, each) as that of what is seen less what is foretold, which changes by `by_before`
        (n, each, 2) with the velocity before."""
        value, vector = np.linalg.eigh(covariance)
        roots = np.sqrt(np.maximum(value, LEAST_VARIANCE))
        self._whiten = vector @ (vector.transpose(0, 2, 1) / roots[:, :, None])
        drift = -by_before @ self.data.drift[:, 0]
        drift[:, :2] += self.data.drift[:, 1]
        self._drift = self.whitened(drift)

    @property
    @abstractmethod
    def observed(self) -> np.ndarray:
        """What `predicted` foretells, as it was seen."""

    @abstractmethod
    def predicted(self, values: Mapping[str, float]) -> np.ndarray:
        """Velocities (n, each) [m/s] under a law: after the contact along the normal, the tangent, and others."""

    @abstractmethod
    def allowing(self, values: Mapping[str, float], now: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Residuals or columns (each n, k) with further noise: the glides' law, common to all contacts, and the spin.

        now: what the law foretells, as `predicted` gives it.
        """

    def with_recoil(self, values: Mapping[str, float], impulses: np.ndarray) -> np.ndarray:
        """Changes of what `predicted` gives (n, each, k), of which those of the puck's velocity are known, with all
        that comes with them."""
        return impulses

    def residuals(self, values: Mapping[str, float], free: Sequence[str], clusters: np.ndarray) -> Residuals:
        """See `Problem.residuals`: velocities after each contact, seen less foretold."""
        now = self.predicted(values)
        columns = np.empty((len(self.data), self.each, len(free)))
        for k, name in enumerate(free):
            row = BY_NAME[name]
            at, step = values.get(name, row.default), SHARE_STEP * (row.high - row.low)
            step = step if at + step < row.high else -step
            columns[:, :, k] = (self.predicted({**values, name: at + step}) - now) / step
        r, jacobian = self.whitened(self.observed - now), -self.whitened(columns)
        both = self.allowing(values, now, np.concatenate([r[:, None], jacobian], axis=1))
        cluster, unit = np.repeat(self.data.cluster, self.each), self.unit_of_rows
        here = np.isin(cluster, clusters)
        return Residuals(both[here, 0], both[here, 1:], cluster[here], unit[here])

    @property
    def std(self) -> np.ndarray:
        """Noise (n, each) [m/s] of what is seen less what is foretold."""
        inverse = np.linalg.inv(self._whiten)
        return np.sqrt(np.einsum("nij,nij->ni", inverse, inverse))

    @property
    def unit_of_rows(self) -> np.ndarray:
        """The contact (each n,) that each row is of."""
        return np.repeat(np.arange(len(self.data)), self.each)

    def whitened(self, velocities: np.ndarray) -> np.ndarray:
        """Velocities (n, each, …) in units of their noise, as rows (each n, …)."""
        shape = velocities.shape
        flat = velocities.reshape(len(self.data), self.each, int(np.prod(shape[2:])))  # there may be none
        return np.einsum("nij,njk->nik", self._whiten, flat).reshape(self.each * len(self.data), *shape[2:])

    def _record(self, values: Mapping[str, float]) -> np.void:
        return record_of({**self._common, **values})


def _kinds(data: Contacts) -> dict[str, np.ndarray]:
    """Slow and fast contacts, steep and flat ones: the halves of those there are."""
    if not len(data):
        return {}
    fast, flat = (size > np.median(size) for size in (data.closing, data.angle))
    return {"slow": ~fast, "fast": fast, "steep": ~flat, "flat": flat}
