"""What the engine needs to know of a regime to fit laws to it and to compare them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from puckpilot_env.parameters import make_records
from sim2real.diagnose.engine.gram import Grams
from sim2real.diagnose.engine.law import Law


@dataclass(frozen=True)
class Residuals:
    """Residuals `r` (n,) in units of the sensor's noise, with nuisances (initial states) profiled out.

    `jacobian` (n, free): dr/dparameter, profiled likewise; `cluster` (n,) int: the launch that each comes from, the
    unit of resampling. `unit` (n,) int: the unit that each comes from, where single ones may be wrong altogether.
    """

    r: np.ndarray
    jacobian: np.ndarray
    cluster: np.ndarray
    unit: np.ndarray | None = None


@dataclass(frozen=True)
class Units:
    """The smallest parts of a regime that can be foretold on their own, such as glides or bounces, by `name`: the
    `cluster` (u,) of each, and how many of its residuals are left free by its nuisances, `freedom` (u,). `kinds`:
    which (u,) bool are of a kind that one can record more of."""

    cluster: np.ndarray
    freedom: np.ndarray
    name: str = "pieces"
    kinds: Mapping[str, np.ndarray] = field(default_factory=dict)

    def of(self, clusters: np.ndarray) -> np.ndarray:
        """Indices of the units in these clusters that have residuals to compare."""
        return np.flatnonzero(np.isin(self.cluster, clusters) & (self.freedom > 0.0))


@dataclass(frozen=True)
class Columns:
    """Everything that a regime may lack, as columns of its residuals at one law, summed by unit.

    `listed`: mechanisms; `families`: smooth laws of any shape, by what they depend on (`Law.family`).
    """

    grams: Grams
    listed: Sequence[Law]
    families: Sequence[Law]


class Fittable(Protocol):
    """What fits need of a regime's data; see `Problem`."""

    clusters: int
    freedom: np.ndarray
    units: Units

    def residuals(self, values: Mapping[str, float], free: Sequence[str], clusters: np.ndarray) -> Residuals:
        """Residuals of the pieces in `clusters` (indices) under the law whose parameters are `values`, by the names of
        `puckpilot_env.parameters`; the Jacobian is by the parameters `free`. Names missing in `values` are at default.
        """
        ...


class Problem(Fittable, Protocol):
    """A regime's data.

    `clusters`: how many launches there are, by which intervals and proofs are resampled; `freedom` (clusters,): how
    many of each one's residuals are left free by its nuisances; `units`: its parts; `noise_m`: the sensor's noise [m],
    rms over the residuals; `place_error_m`: by what a calibrated camera has places wrong [m], smoothly, else 0. `base`:
    the baseline's parameters that it can tell; `regime` as in the format.
    `plain`: those of `base` that are fitted first; the rest may lead a fit astray that is far off still.
    """

    regime: str
    base: tuple[str, ...]
    plain: tuple[str, ...]
    noise_m: float
    place_error_m: float

    def columns(self, values: Mapping[str, float], free: Sequence[str], use: np.ndarray | None) -> Columns:
        """The columns of all clusters at a law: the base's, those of other parameters `free`, the listed effects' and
        the families'. What must be looked for, such as a place, is looked for in the clusters `use` alone, or not at
        all where they are None."""
        ...


def record_of(values: Mapping[str, float]) -> np.void:
    """The simulator's record of `values` by name, the others at their defaults. Fits may step out of a range, so that
    none is checked."""
    records = make_records(1)
    for name, value in values.items():
        records[name] = value
    return records[0]
