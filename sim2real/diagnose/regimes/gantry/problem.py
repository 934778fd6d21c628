"""The gantry as an estimation problem: its residuals with candidate laws."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.problem import DesignMatrix
from sim2real.diagnose.regimes.base import UnusableError
from sim2real.diagnose.regimes.gantry.candidates import gantry_design_matrix
from sim2real.diagnose.regimes.gantry.control_tick import find_tick
from sim2real.diagnose.regimes.gantry.data import GantryRecording, read_gantry
from sim2real.diagnose.regimes.gantry.listed_effects import Candidate, candidates
from sim2real.diagnose.regimes.gantry.residuals import GantryResiduals
from sim2real.recording.folder import Recording


class GantryProblem(GantryResiduals):
    """`GantryResiduals` with candidate laws: smooth laws, and the listed `effects`, which are searched if None."""

    def __init__(
        self,
        runs: Sequence[GantryRecording],
        common: Mapping[str, float],
        basis_runs: Sequence[GantryRecording] = (),
        effects: list[Candidate] | None = None,
    ) -> None:
        """See `GantryResiduals`."""
        super().__init__(runs, common, basis_runs)
        self._effects = effects

    def for_holdout(self, runs: Sequence[GantryRecording]) -> GantryProblem:
        """The same laws for runs of holdout data; no effects are searched in them."""
        with_tick = [run.with_tick(self.runs[0].drive_inputs.tick) for run in runs]
        return GantryProblem(with_tick, self.common, self.runs, [])

    def with_found_tick(self) -> GantryProblem:
        """A copy with the identified period of the control loop."""
        tick = find_tick(self)
        return GantryProblem([run.with_tick(tick) for run in self.runs], self.common)

    def columns(
        self, values: Mapping[str, float], free: Sequence[str], use: np.ndarray | None, only: Sequence[Law] = ()
    ) -> DesignMatrix:
        """See `Problem.columns`."""
        if self._effects is None:
            self._effects = candidates(self, {name: self.defaults(name) for name in self.base})
        return gantry_design_matrix(self, self._effects, values, free, only)


def gantry_problem(
    recordings: Sequence[Recording], common: Mapping[str, float], breaks: Sequence[np.ndarray] = ()
) -> tuple[GantryProblem, list[int]]:
    """The gantry problem of the usable `recordings`, and their indices.

    `common`: shared parameters, by the names of `recording.table_parameters`; `breaks`: for each recording, the times
    (k,) [s] at which the puck pushed the mallet. Raises UnusableError with the reason if no recording is usable.
    """
    times_of = breaks or [np.zeros(0)] * len(recordings)
    runs: dict[int, GantryRecording] = {}
    reasons: list[str] = []
    for k, (recording, times) in enumerate(zip(recordings, times_of, strict=True)):
        try:
            runs[k] = read_gantry(recording, common["max_voltage"], times)
        except UnusableError as why:
            reasons.insert(0 if recording.mallet is not None else len(reasons), str(why))
    if not runs:
        raise UnusableError(reasons[0])
    return GantryProblem(list(runs.values()), common), list(runs)
