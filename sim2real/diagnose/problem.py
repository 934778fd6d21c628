"""What the engine needs to know of a regime to fit laws to it and to compare them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np


@dataclass(frozen=True)
class Residuals:
    """Residuals `r` (n,) in units of the sensor's noise, with nuisances (initial states) profiled out.

    `jacobian` (n, free): dr/dparameter, profiled likewise; `cluster` (n,) int: the launch that each comes from, the
    unit of resampling.
    """

    r: np.ndarray
    jacobian: np.ndarray
    cluster: np.ndarray


class Problem(Protocol):
    """A regime's data. `clusters`: how many launches (units of resampling) there are."""

    regime: str
    clusters: int

    def residuals(self, values: Mapping[str, float], free: Sequence[str], clusters: np.ndarray) -> Residuals:
        """Residuals of the pieces in `clusters` (indices) under the law whose parameters are `values`, by the names of
        `puckpilot_env.parameters`; the Jacobian is by the parameters `free`."""
        ...


@dataclass(frozen=True)
class Candidate:
    """A mechanism that a problem may lack: the parameters that it frees, and where to start the fit of each."""

    mechanism: str
    free: tuple[str, ...]
    starts: tuple[Mapping[str, float], ...] = ({},)
