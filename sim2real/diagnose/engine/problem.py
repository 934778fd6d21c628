"""The interface that a regime implements so that the engine can fit and compare laws.

A cluster is a launch of the puck: residuals within a cluster are dependent, those of two clusters are independent. A
unit is the smallest part of a launch that can be predicted separately, such as a glide or a wall contact.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from puckpilot_env.parameters import make_records
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.linear.normal_equations import NormalEquations


@dataclass(frozen=True)
class Residuals:
    """Residuals `r` (n,) in units of the sensor's noise, with nuisance parameters (initial states) profiled out.

    `jacobian` (n, free): dr/dparameter, profiled likewise. `cluster` (n,) int: the launch of each, the unit of
    resampling. `unit` (n,) int: the unit of each if single units may be outliers, else None.
    """

    r: np.ndarray
    jacobian: np.ndarray
    cluster: np.ndarray
    unit: np.ndarray | None = None


@dataclass(frozen=True)
class Units:
    """The units of a regime, called `name` in messages.

    `cluster` (u,): the launch of each; `freedom` (u,): degrees of freedom, residuals minus nuisance parameters;
    `kinds`: by name, which (u,) bool are of a kind that a user can record more of.
    """

    cluster: np.ndarray
    freedom: np.ndarray
    name: str = "segments"
    kinds: Mapping[str, np.ndarray] = field(default_factory=dict)

    def of(self, clusters: np.ndarray) -> np.ndarray:
        """Return the indices of the units in these clusters that have degrees of freedom."""
        return np.flatnonzero(np.isin(self.cluster, clusters) & (self.freedom > 0.0))


@dataclass(frozen=True)
class DesignMatrix:
    """The derivatives of a regime's residuals by all candidate parameters, as normal `equations` of each unit.

    `listed`: mechanisms of the simulator; `families`: smooth terms of the basis library, by the quantity they depend
    on.
    """

    equations: NormalEquations
    listed: Sequence[Law]
    families: Sequence[Law]


class Fittable(Protocol):
    """The part of a `Problem` that a fit needs."""

    clusters: int
    freedom: np.ndarray
    units: Units

    def residuals(self, values: Mapping[str, float], free: Sequence[str], clusters: np.ndarray) -> Residuals:
        """Return the residuals of `clusters` (indices) and their derivatives by the parameters `free`.

        `values`: parameters by the names of `puckpilot_env.parameters`; missing names are at default.
        """
        ...


class Problem(Fittable, Protocol):
    """A regime's data.

    `clusters`: the number of launches; `freedom` (clusters,): degrees of freedom of each; `units`: its parts;
    `noise_m`: the sensor's noise [m], rms over the residuals; `place_error_m`: the smooth error of a calibrated
    camera's map [m], else 0. `regime` as in the format. `base`: the baseline's parameters that the data determine;
    `first_fitted`: those of `base` that are fitted first, since a fit of all from a distant start may diverge.
    """

    regime: str
    base: tuple[str, ...]
    first_fitted: tuple[str, ...]
    noise_m: float
    place_error_m: float

    def columns(
        self, values: Mapping[str, float], free: Sequence[str], use: np.ndarray | None, only: Sequence[Law] = ()
    ) -> DesignMatrix:
        """Return the design matrix of all clusters at the parameters `values`.

        It has the columns of the base, of other parameters `free`, of the listed laws and of the smooth terms. The
        start of a nonlinear law, such as a place, is searched for in the clusters `use` alone, or not at all if None.
        Smooth terms whose place or size is searched for are too. `only`: the smooth terms wanted, instead of all.
        """
        ...


def record_of(values: Mapping[str, float]) -> np.void:
    """Return the simulator's record of `values` by name, the others at default.

    Ranges are not checked, since the steps of a fit may leave them.
    """
    records = make_records(1)
    for name, value in values.items():
        records[name] = value
    return records[0]
