"""The size of an effect in metres, whatever its p-value: an effect too small to be seen on a table is not reported."""

from __future__ import annotations

import numpy as np

from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.engine.problem import Problem
from sim2real.diagnose.regimes.base import Regime


def effect_size(regime: Regime, problem: Problem, found: SearchResult, other: SearchResult) -> float:
    """Return the rms difference [m] between the predictions of two models over all data: see `Regime.size`.

    For a law that the simulator cannot represent, it is the rms of the residuals that the law explains, with initial
    states refitted.
    """
    if all(one.unlisted is None or one.effect_parameters() for one in (found, other)):
        return regime.size(problem, found, other)
    units = problem.units.of(found.clusters)
    share = max(found.gained(units), 0.0) / max(problem.units.freedom[units].sum(), 1.0)
    return problem.noise_m * float(np.sqrt(share))
