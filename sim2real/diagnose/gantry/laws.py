"""All that a gantry may lack, as columns of its residuals: the listed effects, and smooth laws of any shape.

The mallet is followed so finely that no effect is a small change: each is fitted as it is, with the baseline beside
it, and its column is how the residuals then differ. Of the best, every other effect is tried on top as well.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from puckpilot_env.parameters import BY_NAME
from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import LEAST_FIT, Law
from sim2real.diagnose.engine.fit import Fit, fit
from sim2real.diagnose.gantry.families import families
from sim2real.diagnose.problem import Columns

if TYPE_CHECKING:
    from sim2real.diagnose.gantry.problem import GantryProblem

# where fits of an effect start; of several, the best looking by their derivatives are followed up
STARTS: dict[str, tuple[dict[str, float], ...]] = {
    "voltage_sag": ({},),
    "motor_deadband": ({},),
    "command_delay": tuple({"command_delay": late} for late in (0.0, 0.01, 0.03)),
    "belt_compliance": tuple({"belt_hz": hz, "belt_zeta": 0.15} for hz in (5.0, 8.0, 12.0, 18.0, 28.0, 45.0, 70.0)),
    "backlash": tuple({"backlash_gap": gap} for gap in (2e-4, 7e-4, 2e-3)),
}
FOLLOWED = 2
SAMPLES = 2500  # for the fits of each effect; the chosen law is fitted anew to all


def gantry_columns(problem: GantryProblem, values: Mapping[str, float]) -> Columns:
    """Every column of a gantry problem at one law; at a law that has an effect already, no other is looked for."""
    rows = {name: _rows(name) for name in STARTS}
    on = [name for name in rows if any(values.get(r, BY_NAME[r].default) != BY_NAME[r].default for r in rows[name])]
    free = (*problem.base, *(row for name in on for row in rows[name]))
    exact = problem.residuals(values, free, np.arange(problem.clusters))
    off = [
        row for name in rows if name not in on for row in rows[name]
    ]  # where a fit ended with them off, they stay so
    names, blocks, listed = [*free, *off], [exact.jacobian, np.zeros((len(exact.r), len(off)))], []
    for name, beside, law, before in [] if on else _fitted(problem, values, exact.r):
        column = name + beside
        listed.append(Law(name, (column,), start={row: law.values[row] for row in (*problem.base, *rows[name])}))
        names.append(column)
        blocks.append((_all(problem, law) - before)[:, None])
    laws, columns = families(problem, problem.record(values))
    names += [column for law in laws for column in law.columns]
    grams = gram.make_grams(names, exact.r, np.concatenate([*blocks, columns], axis=1), exact.cluster, problem.clusters)
    return Columns(grams, listed, laws)


def _fitted(
    problem: GantryProblem, values: Mapping[str, float], r: np.ndarray
) -> list[tuple[str, str, Fit, np.ndarray]]:
    """Effects that could be fitted: name, what stood beside it, the law, and the residuals (n,) before it was added."""
    thin = problem.thinned(SAMPLES)
    base = fit(thin, values, thin.base, thin.seen)
    singles = _sound({name: best_fit(thin, base, name) for name in STARTS})
    found = [(name, "", law, r) for name, law in singles.items()]
    best = min(singles, key=lambda name: singles[name].loss, default=None)
    if best is not None and base.loss - singles[best].loss > LEAST_FIT:
        first = singles[best]
        both = _sound({name: best_fit(thin, first, name) for name in STARTS if name != best})
        found += [(name, f" beside {best}", law, _all(problem, first)) for name, law in both.items()]
    return found


def _all(problem: GantryProblem, law: Fit) -> np.ndarray:
    return problem.residuals(law.values, (), np.arange(problem.clusters)).r


def _sound(fits: Mapping[str, Fit]) -> dict[str, Fit]:
    """The fits whose effect did not end at a bound of its range: such a number stands for something else."""
    return {name: law for name, law in fits.items() if not set(law.bound) & set(_rows(name))}


def _rows(name: str) -> tuple[str, ...]:
    return tuple(row.name for row in EFFECTS[name].rows.values())


def best_fit(problem: GantryProblem, law: Fit, name: str) -> Fit:
    """The best fit of an effect on top of `law`, all whose free parameters stay free."""
    free = (*law.free, *_rows(name))
    starts = [{**law.values, **start} for start in STARTS[name]]
    if len(starts) > FOLLOWED:
        starts.sort(key=lambda start: _promise(problem, start, free))
    fits = [fit(problem, start, free, problem.seen) for start in starts[:FOLLOWED]]
    return min(fits, key=lambda one: one.loss)


def _promise(problem: GantryProblem, start: Mapping[str, float], free: tuple[str, ...]) -> float:
    """What a law would leave if it were as its derivatives at `start` say."""
    found = problem.residuals(start, free, problem.seen)
    sums = gram.make_grams(free, found.r, found.jacobian, found.cluster, problem.clusters)
    columns = np.arange(len(free))
    theta = gram.solve(sums, columns, problem.seen)
    return float(gram.losses(sums, columns, theta, problem.seen).sum())
