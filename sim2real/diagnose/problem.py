"""What the engine needs to know of a regime to fit laws to it and to compare them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sim2real.diagnose.engine.choose import Law
from sim2real.diagnose.engine.gram import Grams


@dataclass(frozen=True)
class Residuals:
    """Residuals `r` (n,) in units of the sensor's noise, with nuisances (initial states) profiled out.

    `jacobian` (n, free): dr/dparameter, profiled likewise; `cluster` (n,) int: the launch that each comes from, the
    unit of resampling.
    """

    r: np.ndarray
    jacobian: np.ndarray
    cluster: np.ndarray


@dataclass(frozen=True)
class Columns:
    """Everything that a regime may lack, as columns of its residuals at one law.

    `listed`: mechanisms; `families`: smooth laws of any shape, by what they depend on (`Law.family`).
    """

    grams: Grams
    listed: Sequence[Law]
    families: Sequence[Law]


class Problem(Protocol):
    """A regime's data.

    `clusters`: how many launches (units of resampling) there are; `freedom` (clusters,): how many of each one's
    residuals are left free by its nuisances; `noise_m`: the sensor's noise [m], rms over the residuals. `base`: the
    baseline's parameters that it can tell; `regime` as in the format.
    """

    regime: str
    base: tuple[str, ...]
    clusters: int
    freedom: np.ndarray
    noise_m: float

    def residuals(self, values: Mapping[str, float], free: Sequence[str], clusters: np.ndarray) -> Residuals:
        """Residuals of the pieces in `clusters` (indices) under the law whose parameters are `values`, by the names of
        `puckpilot_env.parameters`; the Jacobian is by the parameters `free`. Names missing in `values` are at default.
        """
        ...

    def columns(self, values: Mapping[str, float], free: Sequence[str] = ()) -> Columns:
        """The columns of all clusters at a law: the base's, those of other parameters `free`, the listed effects' and
        the families'."""
        ...

    def rows(self, law: Law) -> tuple[str, ...]:
        """The parameters that a nonlinear fit of a listed law frees."""
        ...
