"""Whether recordings of one call are of one table: one set of numbers for both, or better one for each (Chow, 1960)?

Asked of every law that the recordings ask for, alone or together, so that physics that is missing in both, or that
happened in one by chance, is not taken for another table.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine import normal_equations
from sim2real.diagnose.engine.law import Model
from sim2real.diagnose.engine.least_squares import LeastSquaresFit, fit
from sim2real.diagnose.engine.model_search import SearchResult, search_model
from sim2real.diagnose.engine.problem import Problem
from sim2real.diagnose.input_checks import two_tables
from sim2real.diagnose.regimes.base import RecordingPart
from sim2real.diagnose.tuned import CONSISTENCY
from sim2real.statistics.robust import group_loss


def check_consistency(problem: Problem, defaults: Mapping[str, float], parts: Sequence[RecordingPart]) -> None:
    """Raise `UndeterminedError` if what recordings ask for cannot be one table.

    `defaults`: the simulator's own numbers, by name.
    """
    live = np.flatnonzero(problem.freedom > 0)
    parts = [RecordingPart(part.name, np.intersect1d(part.clusters, live)) for part in parts]
    parts = [part for part in parts if len(part.clusters)]
    if len(parts) < 2:
        return
    asking = [part.clusters for part in parts if _enough(problem, part.clusters)]
    if len(asking) < len(parts):
        together = np.concatenate([part.clusters for part in parts])
        asking += [together] if _enough(problem, together) else []
    for clusters in asking:
        found = search_model(problem, defaults, clusters)
        for one, other in combinations(parts, 2):
            why = _apart_smoothly(problem, found, one, other) if found.unlisted else _apart(problem, found, one, other)
            if why:
                raise two_tables(one.name, other.name, why)
        for part in parts:
            why = _strange(problem, found, clusters, part)
            if why:
                asker = next((one.name for one in parts if np.array_equal(one.clusters, clusters)), "the others")
                raise two_tables(asker, part.name, why)


def _enough(problem: Problem, clusters: np.ndarray) -> bool:
    return (
        len(clusters) >= CONSISTENCY.fewest_launches and problem.freedom[clusters].sum() >= CONSISTENCY.fewest_residuals
    )


def _apart(problem: Problem, found: SearchResult, one: RecordingPart, other: RecordingPart) -> str | None:
    """What a law's numbers in two recordings differ by, if they surely do."""
    free = found.law.free
    both = fit(problem, found.law.values, free, np.concatenate([one.clusters, other.clusters]))
    each = [fit(problem, both.values, free, part.clusters) for part in (one, other)]
    left = sum(some.loss for some in each)
    freedom = sum(problem.freedom[part.clusters].sum() for part in (one, other)) - 2 * len(free)
    if both.loss - left < CONSISTENCY.harm * max(left / max(freedom, 1.0), 1.0):
        return None
    return _numbers_apart(*each)


def _numbers_apart(one: LeastSquaresFit, other: LeastSquaresFit) -> str | None:
    """The number that two fits disagree on most, if they surely do."""
    worst, told = CONSISTENCY.deviations, None
    for k, name in enumerate(one.free):
        a, b = float(one.values[name]), float(other.values[name])
        apart = abs(a - b) / max(float(np.sqrt(one.covariance[k, k] + other.covariance[k, k])), 1e-12)
        if apart > worst and abs(a - b) > CONSISTENCY.relative * max(abs(a), abs(b)):
            worst, told = apart, f"{name} is {a:.3g} in the one and {b:.3g} in the other"
    return told


def _apart_smoothly(problem: Problem, found: SearchResult, one: RecordingPart, other: RecordingPart) -> str | None:
    """The same for a smooth law beside the others: its coefficients have no meaning by themselves."""
    both = _losses(problem, found, np.concatenate([one.clusters, other.clusters]))
    each = _losses(problem, found, one.clusters) + _losses(problem, found, other.clusters)
    for part in (one, other):
        shared, own = both[part.clusters].sum(), each[part.clusters].sum()
        if shared - own > CONSISTENCY.harm * found.dispersion and shared > CONSISTENCY.worse_unlisted * own:
            return f"what the {problem.regime} of the one asks for makes the other's worse"
    return None


def _strange(problem: Problem, found: SearchResult, clusters: np.ndarray, part: RecordingPart) -> str | None:
    """What a recording shows of another table, if the law that explains `clusters` does worse there than none, or
    explains them to the noise but has no numbers that do so there."""
    if _harms(problem, found, part.clusters):
        return f"what the {problem.regime} of the one asks for makes the other's worse"
    quiet = _own_loss(problem, found, clusters) < CONSISTENCY.explained * problem.freedom[clusters].sum()
    if (
        quiet
        and _own_loss(problem, found, part.clusters)
        > CONSISTENCY.unexplained * problem.freedom[part.clusters].sum() + CONSISTENCY.harm
    ):
        return f"the {problem.regime} of the one foretells the other's badly"
    return None


def _harms(problem: Problem, found: SearchResult, clusters: np.ndarray) -> bool:
    """Whether the listed laws found elsewhere leave more of `clusters` than none, the baseline's numbers refitted."""
    if not found.listed:
        return False
    none = {**found.law.values, **{row: BY_NAME[row].default for law in found.listed for row in law.rows}}
    worse, plain = (fit(problem, values, problem.base, clusters).loss for values in (found.law.values, none))
    return worse > CONSISTENCY.worse * plain and worse - plain > CONSISTENCY.harm * found.dispersion


def _own_loss(problem: Problem, found: SearchResult, clusters: np.ndarray) -> float:
    """Soft loss that a law leaves of `clusters` with numbers of their own."""
    if found.unlisted:
        return float(_losses(problem, found, clusters).sum())
    return fit(problem, found.law.values, found.law.free, clusters).loss


def _losses(problem: Problem, found: SearchResult, clusters: np.ndarray) -> np.ndarray:
    """Soft losses (all clusters,) of `clusters` under a smooth law fitted to them; zeros elsewhere."""
    assert found.unlisted is not None
    spread = found.model.spreads[found.model.laws.index(found.unlisted)]
    equations, units = found.columns.equations, problem.units.of(clusters)
    index, ridge = Model(found.law.free, (found.unlisted,), (spread,)).columns(equations)
    freedom = problem.units.freedom[units]
    theta = normal_equations.solve_robustly(equations, index, units, freedom, ridge)
    left = group_loss(normal_equations.losses(equations, index, theta, units), freedom)
    return np.bincount(problem.units.cluster[units], left, problem.clusters)
