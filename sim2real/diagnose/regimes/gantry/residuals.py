"""Residuals of the mallet's paths: observed positions minus those predicted from the drive inputs under a law."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine.problem import Residuals, Units, record_of
from sim2real.diagnose.regimes.gantry.data import GantryRecording
from sim2real.diagnose.regimes.gantry.tuned import GANTRY_FIT

PRIOR_PARAMETERS = ("a1", "b1")  # coefficients of the jerk: almost equivalent to a delay, so they have a prior
LOW_ORDER = ("a2", "a3", "b2", "b3")  # the baseline's other parameters
MIRRORED = {"b1": "a1", "b2": "a2", "b3": "a3"}  # x depends on a - b, y on a + b, unless friction couples the axes


class GantryResiduals:
    """Residuals of the mallet's paths; parameters missing from `values` are those of `common`, or the defaults."""

    regime = "gantry"
    base: tuple[str, ...] = ("a1", "a2", "a3", "b1", "b2", "b3")
    first_fitted: tuple[str, ...] = LOW_ORDER

    def __init__(
        self,
        runs: Sequence[GantryRecording],
        common: Mapping[str, float],
        basis_runs: Sequence[GantryRecording] = (),
    ) -> None:
        """`common`: parameters that all laws share, e.g. the pulley's radius; `basis_runs`: the runs to which smooth
        laws were fitted, if not `runs`.

        Clusters are blocks of some seconds, numbered over the runs in order.
        """
        self.runs, self.common = tuple(runs), dict(common)
        self.basis_runs = tuple(basis_runs) or self.runs
        self.first = np.cumsum([0, *(run.windows.clusters for run in runs)])
        self.clusters = int(self.first[-1])
        self.freedom = np.concatenate([run.freedom() for run in runs])
        self.units = Units(np.arange(self.clusters), self.freedom)
        self.noise_m = float(np.sqrt(np.mean(np.concatenate([run.noise for run in runs]) ** 2)))
        self.place_error_m = 0.0  # no camera
        sizes = [len(run.windows.rows) for run in runs]
        self._sign = [np.repeat((-1.0, 1.0), size) for size in sizes]
        self._cluster = [a + run.cluster_of_rows() for a, run in zip(self.first, runs, strict=False)]
        self._prior_cluster = np.repeat(np.arange(self.clusters), len(PRIOR_PARAMETERS))

    @property
    def cluster(self) -> np.ndarray:
        """The cluster of each row of the residuals of all clusters."""
        return np.concatenate([*self._cluster, self._prior_cluster])

    @property
    def clusters_of_runs(self) -> list[np.ndarray]:
        """The clusters of each run."""
        return [np.arange(a, b) for a, b in pairwise(self.first.tolist())]

    def of(self, runs: Sequence[GantryRecording]) -> GantryResiduals:
        """The residuals of other runs."""
        return GantryResiduals(runs, self.common)

    def thinned(self, samples: int) -> GantryResiduals:
        """A copy with about `samples` encoder samples in total, for fast fits."""
        share = samples / sum(len(run.t) for run in self.runs)
        runs = [run.thinned(max(1, int(share * len(run.t)))) for run in self.runs]
        return GantryResiduals(runs, self.common)

    def residuals(self, values: Mapping[str, float], free: Sequence[str], clusters: np.ndarray) -> Residuals:
        """See `Problem.residuals`. They are `GANTRY_FIT.impossible` if an axis is not overdamped.

        The last two rows of each cluster are the prior of PRIOR_PARAMETERS, which the path alone hardly determines if
        the plans are delayed.
        """
        p = self.record(values)
        of_runs = np.unique(np.searchsorted(self.first, clusters, side="right") - 1).tolist()  # no others are simulated
        runs = [self.runs[k] for k in of_runs]
        friction = [run.friction(p) for run in runs]
        r, sign = _path(runs, p, friction), np.concatenate([self._sign[k] for k in of_runs])
        coupled = any(part.any() for part in friction)
        jacobian = np.empty((len(r), len(free)))
        mirrored = {} if coupled else {name: MIRRORED[name] for name in free if MIRRORED.get(name) in free}
        separate = [name for name in free if name not in mirrored]
        threads = min(os.cpu_count() or 1, len(separate)) if coupled else 1  # with friction a kernel takes long
        with ThreadPoolExecutor(max(threads, 1)) as pool:
            slopes = dict(zip(separate, pool.map(lambda name: _slope(runs, p, name, r), separate), strict=True))
        for k, name in enumerate(free):
            jacobian[:, k] = slopes[name] if name in slopes else sign * slopes[mirrored[name]]
        centre = np.array([self.defaults(name) for name in PRIOR_PARAMETERS])
        weight = 1.0 / (GANTRY_FIT.prior_share * np.abs(centre)) / np.sqrt(self.clusters)
        off = np.array([p[name] for name in PRIOR_PARAMETERS]) - centre
        r = np.concatenate([r, np.tile(weight * off, self.clusters)])
        is_free = np.array([[one == name for name in free] for one in PRIOR_PARAMETERS]).reshape(len(off), -1)
        slopes = weight[:, None] * is_free
        jacobian = np.concatenate([jacobian, np.tile(slopes, (self.clusters, 1))])
        cluster = np.concatenate([*(self._cluster[k] for k in of_runs), self._prior_cluster])
        here = np.isin(cluster, clusters)
        return Residuals(r[here], jacobian[here], cluster[here])

    def defaults(self, name: str) -> float:
        """The default value of a parameter."""
        return float(self.common.get(name, BY_NAME[name].default))

    @property
    def windows(self) -> int:
        """Number of windows of all runs."""
        return sum(len(run.windows.cluster) for run in self.runs)

    @property
    def everything(self) -> np.ndarray:
        """The indices of all clusters."""
        return np.arange(self.clusters)

    def record(self, values: Mapping[str, float]) -> np.void:
        """The simulator's parameter record for `values`."""
        return record_of({**self.common, **values})


def _path(runs: Sequence[GantryRecording], p: np.void, friction: list[np.ndarray], delay: float = 0.0) -> np.ndarray:
    """Whitened residuals (rows,) of the path, run by run."""
    parts = [run.residuals(p, delay, friction=part)[:, 0] for run, part in zip(runs, friction, strict=True)]
    r = np.concatenate(parts)
    return np.where(np.isfinite(r), r, GANTRY_FIT.impossible)


def _slope(runs: Sequence[GantryRecording], p: np.void, name: str, r: np.ndarray) -> np.ndarray:
    """Derivative (rows,) of the path's residuals by a parameter; `r` (rows,): the residuals at `p`.

    Friction's displacement depends on the parameters of the axes about as much as on those of friction.
    """
    step = _step(name, float(p[name]))
    moved, delay = p.copy(), 0.0
    if name == "command_delay":
        delay = step  # shifts the changes themselves: with ticks, the effect of the parameter is discontinuous
    else:
        moved[name] += step
    friction = [run.friction(moved, delay) for run in runs]
    return (_path(runs, moved, friction, delay) - r) / step


def _step(name: str, value: float) -> float:
    """The difference step of a parameter at `value`, within its range."""
    row = BY_NAME[name]
    size = max(abs(value), abs(row.default), GANTRY_FIT.least_size * (row.high - row.low))
    step = GANTRY_FIT.difference_step * size
    return step if value + step <= row.high else -step
