"""The gantry as a problem for the engine: how far the mallet is from where its orders should have brought it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.gantry.candidates import PLAIN, Candidate, candidates
from sim2real.diagnose.gantry.laws import gantry_columns
from sim2real.diagnose.gantry.run import Run, UnusableError, read_run
from sim2real.diagnose.gantry.tick import find_tick
from sim2real.diagnose.problem import Columns, Residuals, Units, record_of
from sim2real.recording import Recording

GUESSED, GUESS = ("a1", "b1"), 0.2  # known beforehand to this share of the simulator's own: nearly a delay of the path
TWINS = {"b1": "a1", "b2": "a2", "b3": "a3"}
STEP = 1e-6  # of a parameter's size, for its derivative
FAR = 1e6  # standard deviations: a law that no axis can have is worse than any other
SMALLEST_SIZE = 1e-3  # of a parameter's range, where it is zero


class GantryProblem:
    """The mallet's paths of some recordings. Parameters that `values` leave out are common to all, or at default."""

    regime = "gantry"
    base: tuple[str, ...] = ("a1", "a2", "a3", "b1", "b2", "b3")
    plain: tuple[str, ...] = PLAIN

    def __init__(self, runs: Sequence[Run], common: Mapping[str, float], proof: np.ndarray | None = None) -> None:
        """`common`: what every law shares, e.g. the pulley's radius; `proof`: clusters that no fit may see.

        Clusters are blocks of seconds, numbered through the runs in order.
        """
        self.runs, self._common = tuple(runs), dict(common)
        self.first = np.cumsum([0, *(run.windows.clusters for run in runs)])
        self.clusters = int(self.first[-1])
        self.freedom = np.concatenate([run.freedom() for run in runs])
        self.units = Units(np.arange(self.clusters), self.freedom)
        self.noise_m = float(np.sqrt(np.mean(np.concatenate([run.noise for run in runs]) ** 2)))
        self.place_error_m = 0.0  # no camera
        self.proof = np.zeros(0, int) if proof is None else proof
        self.seen = np.setdiff1d(np.arange(self.clusters), self.proof)
        self._candidates: list[Candidate] | None = None
        sizes = [len(run.windows.rows) for run in runs]
        self._sign = np.concatenate([np.repeat((-1.0, 1.0), size) for size in sizes])
        of_rows = [a + run.cluster_of_rows() for a, run in zip(self.first, runs, strict=False)]
        self.cluster = np.concatenate([*of_rows, np.repeat(np.arange(self.clusters), len(GUESSED))])

    @property
    def clusters_of_runs(self) -> list[np.ndarray]:
        """The clusters of each run."""
        return [np.arange(a, b) for a, b in pairwise(self.first.tolist())]

    def of(self, runs: Sequence[Run]) -> GantryProblem:
        """The same of other runs, all to be seen."""
        return GantryProblem(runs, self._common)

    def proved_on(self, heldout: int, every: int) -> GantryProblem:
        """The same with clusters that no fit may see: those of the last `heldout` runs, or every so manieth."""
        clusters = np.arange(self.clusters)
        apart = clusters[self.first[len(self.runs) - heldout] :] if heldout else clusters[every - 1 :: every]
        return GantryProblem(self.runs, self._common, apart)

    def ticked(self) -> GantryProblem:
        """The same with the ticks at which the motors heed plans, as what may be seen tells."""
        tick = find_tick(self)
        return GantryProblem([run.with_tick(tick) for run in self.runs], self._common, self.proof)

    def thinned(self, samples: int) -> GantryProblem:
        """The same with so many samples of the encoders in all: for fits that are to be fast rather than fine."""
        share = samples / sum(len(run.t) for run in self.runs)
        runs = [run.thinned(max(1, int(share * len(run.t)))) for run in self.runs]
        return GantryProblem(runs, self._common, self.proof)

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
        weight = np.array([1.0 / (GUESS * abs(self._shipped(name))) for name in GUESSED]) / np.sqrt(self.clusters)
        off = np.array([p[name] - self._shipped(name) for name in GUESSED])
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

    def columns(self, values: Mapping[str, float], free: Sequence[str], use: np.ndarray | None) -> Columns:
        """See `Problem.columns`."""
        return gantry_columns(self, values, free)

    def candidates(self) -> list[Candidate]:
        """The listed effects that may be there, fitted once, from the simulator's own numbers."""
        if self._candidates is None:
            self._candidates = candidates(self, {name: self._shipped(name) for name in self.base})
        return self._candidates

    def _shipped(self, name: str) -> float:
        return float(self._common.get(name, BY_NAME[name].default))

    @property
    def seen_windows(self) -> np.ndarray:
        """Indices, through all runs, of the windows in the clusters `seen`."""
        cluster = np.concatenate([a + run.windows.cluster for a, run in zip(self.first, self.runs, strict=False)])
        return np.flatnonzero(np.isin(cluster, self.seen))

    def record(self, values: Mapping[str, float]) -> np.void:
        """A record of all parameters under the law `values`."""
        return record_of({**self._common, **values})

    def _path(self, p: np.void, late: float = 0.0) -> np.ndarray:
        r = np.concatenate([run.residuals(p, late)[:, 0] for run in self.runs])
        return np.where(np.isfinite(r), r, FAR)


def gantry_problem(
    recordings: Sequence[Recording], common: Mapping[str, float], breaks: Sequence[np.ndarray] = ()
) -> tuple[GantryProblem, list[int]]:
    """The gantry in those of `recordings` that show it, and their indices; `breaks`: for each recording, the times [s]
    at which something else pushed the mallet. `common`: what they all share, by the names of `nominal.parameters`.

    Errors: UnusableError, why none of them says anything.
    """
    given = breaks or [np.zeros(0)] * len(recordings)
    runs: dict[int, Run] = {}
    reasons: list[str] = []
    for k, (recording, times) in enumerate(zip(recordings, given, strict=True)):
        try:
            runs[k] = read_run(recording, common["max_voltage"], times)
        except UnusableError as why:
            reasons.insert(0 if recording.mallet is not None else len(reasons), str(why))
    if not runs:
        raise UnusableError(reasons[0])
    return GantryProblem(list(runs.values()), common), list(runs)


def _step(name: str, value: float) -> float:
    row = BY_NAME[name]
    size = max(abs(value), abs(row.default), SMALLEST_SIZE * (row.high - row.low))
    step = STEP * size
    return step if value + step <= row.high else -step
