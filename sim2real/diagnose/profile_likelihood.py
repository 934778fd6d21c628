"""Intervals of parameters in which the prediction is not smooth, as where a contact grips or slides.

Curvature at the optimum says nothing beyond such a place: a loss that is flat to one side of it has an interval that
reaches as far as the loss, minimized over the other parameters, stays low (Venzon, Moolgavkar, Appl. Stat. 37, 1988).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine.least_squares import LeastSquaresFit, fit
from sim2real.diagnose.engine.problem import Fittable
from sim2real.diagnose.engine.tuned import ENGINE
from sim2real.statistics.intervals import reach_of_launches


def with_profiles(
    problem: Fittable, law: LeastSquaresFit, names: Sequence[str], clusters: np.ndarray
) -> LeastSquaresFit:
    """The fit of `clusters`, whose intervals of these parameters, where they are free, reach as far as their profile
    likelihoods do."""
    profiled = [name for name in names if name in law.free]
    return replace(law, profiles={name: _limits(problem, law, name, clusters) for name in profiled})


def _limits(problem: Fittable, law: LeastSquaresFit, name: str, clusters: np.ndarray) -> tuple[float, float]:
    """The ends of the 95 % interval, no closer than those by curvature."""
    row, estimate = BY_NAME[name], law.estimate(name)
    freedom = float(problem.freedom[clusters].sum()) - len(law.free)
    allowed = law.loss + reach_of_launches(law.clusters) ** 2 * max(law.loss / max(freedom, 1.0), 1.0)
    others = tuple(one for one in law.free if one != name)

    def is_likely(value: float) -> bool:
        return fit(problem, {**law.values, name: value}, others, clusters).loss < allowed

    def end(likely: float, width: float) -> float:
        while is_likely(likely):
            beyond = float(np.clip(likely + width, row.low, row.high))
            if beyond == likely:
                return likely
            if not is_likely(beyond):
                return between(likely, beyond)
            likely, width = beyond, 2.0 * width
        return likely

    def between(likely: float, beyond: float) -> float:
        for _ in range(ENGINE.profile_halvings):
            middle = 0.5 * (likely + beyond)
            likely, beyond = (middle, beyond) if is_likely(middle) else (likely, middle)
        return beyond

    half = law.reach({name: 1.0})
    return end(estimate.low, -half), end(estimate.high, half)
