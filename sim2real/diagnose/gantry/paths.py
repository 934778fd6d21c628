"""The mallet's paths under a law: how far it is from where its orders should have brought it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.gantry.run import Run
from sim2real.diagnose.problem import Residuals, Units, record_of

PLAIN = ("a2", "a3", "b2", "b3")  # the baseline's numbers but those GUESSED
GUESSED, GUESS = ("a1", "b1"), 0.2  # known beforehand to this share of the simulator's own: nearly a delay of the path
TWINS = {"b1": "a1", "b2": "a2", "b3": "a3"}
STEP = 1e-6  # of a parameter's size, for its derivative
FAR = 1e6  # standard deviations: a law that no axis can have is worse than any other
SMALLEST_SIZE = 1e-3  # of a parameter's range, where it is zero


class GantryPaths:
    """The mallet's paths of some recordings. Parameters that `values` leave out are common to all, or at default."""

    regime = "gantry"
    base: tuple[str, ...] = ("a1", "a2", "a3", "b1", "b2", "b3")
    plain: tuple[str, ...] = PLAIN

    def __init__(
        self,
        runs: Sequence[Run],
        common: Mapping[str, float],
        shaped_by: Sequence[Run] = (),
    ) -> None:
        """`common`: what every law shares, e.g. the pulley's radius; `shaped_by`: the runs that smooth
        laws were fitted to, if they are others.

        Clusters are blocks of seconds, numbered through the runs in order.
        """
        self.runs, self.common = tuple(runs), dict(common)
        self.shaped_by = tuple(shaped_by) or self.runs
        self.first = np.cumsum([0, *(run.windows.clusters for run in runs)])
        self.clusters = int(self.first[-1])
        self.freedom = np.concatenate([run.freedom() for run in runs])
        self.units = Units(np.arange(self.clusters), self.freedom)
        self.noise_m = float(np.sqrt(np.mean(np.concatenate([run.noise for run in runs]) ** 2)))
        self.place_error_m = 0.0  # no camera
        sizes = [len(run.windows.rows) for run in runs]
        self._sign = np.concatenate([np.repeat((-1.0, 1.0), size) for size in sizes])
        of_rows = [a + run.cluster_of_rows() for a, run in zip(self.first, runs, strict=False)]
        self.cluster = np.concatenate([*of_rows, np.repeat(np.arange(self.clusters), len(GUESSED))])

    @property
    def clusters_of_runs(self) -> list[np.ndarray]:
        """The clusters of each run."""
        return [np.arange(a, b) for a, b in pairwise(self.first.tolist())]

    def of(self, runs: Sequence[Run]) -> GantryPaths:
        """The same of other runs, all to be seen."""
        return GantryPaths(runs, self.common)

    def thinned(self, samples: int) -> GantryPaths:
        """The same with so many samples of the encoders in all: for fits that are to be fast rather than fine."""
        share = samples / sum(len(run.t) for run in self.runs)
        runs = [run.thinned(max(1, int(share * len(run.t)))) for run in self.runs]
        return GantryPaths(runs, self.common)

    def residuals(self, values: Mapping[str, float], free: Sequence[str], clusters: np.ndarray) -> Residuals:
        """See `Problem.residuals`. Far out (FAR) where an axis would not be overdamped.

        The last rows, some of each cluster, hold the parameters GUESSED to what is known of them beforehand: with a
        late start of the plans, the path alone hardly tells them.
        """
        p = self.record(values)
        r = self._path(p)
        jacobian = np.empty((len(r), len(free)))
        for k, name in enumerate(free):
            twin = TWINS.get(name)  # x feels the difference of the two, y their sum
            jacobian[:, k] = self._sign * jacobian[:, free.index(twin)] if twin in free else self._slope(p, name, r)
        weight = np.array([1.0 / (GUESS * abs(self.shipped(name))) for name in GUESSED]) / np.sqrt(self.clusters)
        off = np.array([p[name] - self.shipped(name) for name in GUESSED])
        r = np.concatenate([r, np.tile(weight * off, self.clusters)])
        slopes = weight[:, None] * np.array([[one == name for name in free] for one in GUESSED]).reshape(len(off), -1)
        jacobian = np.concatenate([jacobian, np.tile(slopes, (self.clusters, 1))])
        here = np.isin(self.cluster, clusters)
        return Residuals(r[here], jacobian[here], self.cluster[here])

    def _slope(self, p: np.void, name: str, r: np.ndarray) -> np.ndarray:
        """The residuals' derivative by a parameter; `r` at `p` itself."""
        step = _step(name, float(p[name]))
        moved, late = p.copy(), 0.0
        if name == "command_delay":
            late = step  # of the changes themselves: ticks would make it a staircase
        else:
            moved[name] += step
        return (self._path(moved, late) - r) / step

    def shipped(self, name: str) -> float:
        """A parameter as the simulator has it."""
        return float(self.common.get(name, BY_NAME[name].default))

    @property
    def windows(self) -> int:
        """How many windows all runs have."""
        return sum(len(run.windows.cluster) for run in self.runs)

    @property
    def everything(self) -> np.ndarray:
        """The indices of all clusters."""
        return np.arange(self.clusters)

    def record(self, values: Mapping[str, float]) -> np.void:
        """A record of all parameters under the law `values`."""
        return record_of({**self.common, **values})

    def _path(self, p: np.void, late: float = 0.0) -> np.ndarray:
        r = np.concatenate([run.residuals(p, late)[:, 0] for run in self.runs])
        return np.where(np.isfinite(r), r, FAR)


def _step(name: str, value: float) -> float:
    row = BY_NAME[name]
    size = max(abs(value), abs(row.default), SMALLEST_SIZE * (row.high - row.low))
    step = STEP * size
    return step if value + step <= row.high else -step
