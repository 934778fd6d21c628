"""The size of an effect in metres, whatever its p-value: an effect too small to be seen on a table is not reported."""

from __future__ import annotations

import numpy as np

from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.engine.problem import Problem
from sim2real.diagnose.regimes.base import Regime


def effect_size(regime: Regime, problem: Problem, found: SearchResult, other: SearchResult) -> float:
    """Return the rms difference [m] between the predictions of the model `found` and the one without a law, `other`,
    over all data: see `Regime.size`.

    For a smooth term that the simulator cannot represent, it is the rms of the residuals that the term explains, with
    initial states refitted.
    """
    if found.unlisted is None or other.unlisted is not None or found.effect_parameters():
        return regime.size(problem, found, other)
    units = problem.units.of(found.clusters)
    share = max(found.gained(units), 0.0) / max(problem.units.freedom[units].sum(), 1.0)
    return problem.noise_m * float(np.sqrt(share))
