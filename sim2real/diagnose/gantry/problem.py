"""The gantry as a problem for the engine: its paths with all that they may lack."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sim2real.diagnose.gantry.candidates import Candidate, candidates
from sim2real.diagnose.gantry.laws import gantry_columns
from sim2real.diagnose.gantry.paths import GantryPaths
from sim2real.diagnose.gantry.run import Run, UnusableError, read_run
from sim2real.diagnose.gantry.tick import find_tick
from sim2real.diagnose.problem import Columns
from sim2real.recording import Recording


class GantryProblem(GantryPaths):
    """`GantryPaths` with the listed effects that may be there (`looked_for`, or as they are found) and smooth laws."""

    def __init__(
        self,
        runs: Sequence[Run],
        common: Mapping[str, float],
        shaped_by: Sequence[Run] = (),
        looked_for: list[Candidate] | None = None,
    ) -> None:
        """See `GantryPaths`."""
        super().__init__(runs, common, shaped_by)
        self._candidates = looked_for

    def proved_on(self, runs: Sequence[Run]) -> GantryProblem:
        """The same laws, of other runs: no effect is looked for in these."""
        ticked = [run.with_tick(self.runs[0].orders.tick) for run in runs]
        return GantryProblem(ticked, self.common, self.runs, [])

    def ticked(self) -> GantryProblem:
        """The same with the ticks at which the motors heed plans."""
        tick = find_tick(self)
        return GantryProblem([run.with_tick(tick) for run in self.runs], self.common)

    def columns(self, values: Mapping[str, float], free: Sequence[str], use: np.ndarray | None) -> Columns:
        """See `Problem.columns`."""
        if self._candidates is None:
            self._candidates = candidates(self, {name: self.shipped(name) for name in self.base})
        return gantry_columns(self, self._candidates, values, free)


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
