"""How much a law matters in millimetres, whatever its p-value: a discovery too small to be seen on a table is none."""

from __future__ import annotations

import numpy as np

from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.engine.problem import Problem
from sim2real.diagnose.regimes.base import Regime


def effect_size(regime: Regime, problem: Problem, found: SearchResult, other: SearchResult) -> float:
    """By how much [m] laws differ in what they predict, rms over all that was recorded: see `Regime.size`.

    Of a law that the simulator has no place for: what it explains of the residuals, starts fitted anew.
    """
    if all(one.unlisted is None or one.effect_parameters() for one in (found, other)):
        return regime.size(problem, found, other)
    units = problem.units.of(found.clusters)
    share = max(found.gained(units), 0.0) / max(problem.units.freedom[units].sum(), 1.0)
    return problem.noise_m * float(np.sqrt(share))
