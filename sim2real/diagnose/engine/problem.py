"""What the engine needs of a regime to fit laws to it and to compare them.

A cluster is a launch of the puck: the residuals of one depend on each other, those of two do not. A unit is the
smallest part of a launch that can be predicted on its own, such as a glide or a bounce.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from puckpilot_env.parameters import make_records
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.normal_equations import NormalEquations


@dataclass(frozen=True)
class Residuals:
    """Residuals `r` (n,) in units of the sensor's noise, with nuisance parameters (initial states) profiled out.

    `jacobian` (n, free): dr/dparameter, profiled likewise. `cluster` (n,) int: the launch of each, by which intervals
    and proofs resample. `unit` (n,) int: the unit of each, where single units may be outliers as a whole, else None.
    """

    r: np.ndarray
    jacobian: np.ndarray
    cluster: np.ndarray
    unit: np.ndarray | None = None


@dataclass(frozen=True)
class Units:
    """The units of a regime, called `name` in messages: the `cluster` (u,) of each, and its degrees of `freedom` (u,):
    residuals less nuisance parameters. `kinds`: by name, which (u,) bool are of a kind that one can record more of."""

    cluster: np.ndarray
    freedom: np.ndarray
    name: str = "pieces"
    kinds: Mapping[str, np.ndarray] = field(default_factory=dict)

    def of(self, clusters: np.ndarray) -> np.ndarray:
        """Indices of the units in these clusters that have degrees of freedom."""
        return np.flatnonzero(np.isin(self.cluster, clusters) & (self.freedom > 0.0))


@dataclass(frozen=True)
class DesignMatrix:
    """The derivatives of a regime's residuals by everything that it may lack, taken at one law, as the normal
    `equations` of each unit.

    `listed`: mechanisms of the simulator; `families`: smooth terms of the basis library, by what they depend on.
    """

    equations: NormalEquations
    listed: Sequence[Law]
    families: Sequence[Law]


class Fittable(Protocol):
    """What a fit needs of a regime's data; see `Problem`."""

    clusters: int
    freedom: np.ndarray
    units: Units

    def residuals(self, values: Mapping[str, float], free: Sequence[str], clusters: np.ndarray) -> Residuals:
        """Residuals of `clusters` (indices) under the parameters `values`, by the names of `puckpilot_env.parameters`,
        and their derivatives by the parameters `free`. Names missing in `values` are at default."""
        ...


class Problem(Fittable, Protocol):
    """A regime's data.

    `clusters`: the number of launches; `freedom` (clusters,): degrees of freedom of each; `units`: its parts;
    `noise_m`: the sensor's noise [m], rms over the residuals; `place_error_m`: the smooth error of a calibrated
    camera's map [m], else 0. `regime` as in the format. `base`: the baseline's parameters that the data determine;
    `first_fitted`: those of `base` that are fitted before the rest, since the rest may lead a fit astray from far off.
    """

    regime: str
    base: tuple[str, ...]
    first_fitted: tuple[str, ...]
    noise_m: float
    place_error_m: float

    def columns(self, values: Mapping[str, float], free: Sequence[str], use: np.ndarray | None) -> DesignMatrix:
        """The design matrix of all clusters at the parameters `values`: columns of the base, of other parameters
        `free`, of the listed laws and of the smooth terms. A nonlinear law's start, such as a place, is searched for in
        the clusters `use` alone, or not at all where they are None."""
        ...


def record_of(values: Mapping[str, float]) -> np.void:
    """Return the simulator's record of `values` by name, the others at default. Ranges are not checked, since the steps
    of a fit may leave them."""
    records = make_records(1)
    for name, value in values.items():
        records[name] = value
    return records[0]
