"""Test whether the recordings of one call are of one table: common parameters against separate ones (Chow, 1960).

The test uses every model that the recordings support, alone or together. Physics that is missing in both recordings, or
that affected one by chance, is therefore not taken for another table.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine.law import Model
from sim2real.diagnose.engine.least_squares import LeastSquaresFit, fit
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.model_search import SearchResult, search_model
from sim2real.diagnose.engine.problem import Problem
from sim2real.diagnose.input_checks import two_tables
from sim2real.diagnose.regimes.base import RecordingPart
from sim2real.diagnose.tuned import CONSISTENCY
from sim2real.statistics.robust import group_loss


def check_consistency(problem: Problem, defaults: Mapping[str, float], parts: Sequence[RecordingPart]) -> None:
    """Raise `UndeterminedError` if the `parts`, the recordings, cannot be of one table.

    `defaults`: the simulator's default parameters by name.
    """
    live = np.flatnonzero(problem.freedom > 0)
    parts = [RecordingPart(part.name, np.intersect1d(part.clusters, live)) for part in parts]
    parts = [part for part in parts if len(part.clusters)]
    if len(parts) < 2:
        return
    training_sets = [part.clusters for part in parts if _enough(problem, part.clusters)]
    if len(training_sets) < len(parts):
        together = np.concatenate([part.clusters for part in parts])
        training_sets += [together] if _enough(problem, together) else []
    for clusters in training_sets:
        found = search_model(problem, defaults, clusters)
        for one, other in combinations(parts, 2):
            compare = _compare_smooth_terms if found.unlisted else _compare_parameters
            why = compare(problem, found, one, other)
            if why:
                raise two_tables(one.name, other.name, why)
        for part in parts:
            why = _does_not_transfer(problem, found, clusters, part)
            if why:
                first = next((one.name for one in parts if np.array_equal(one.clusters, clusters)), "the others")
                raise two_tables(first, part.name, why)


def _enough(problem: Problem, clusters: np.ndarray) -> bool:
    return (
        len(clusters) >= CONSISTENCY.fewest_launches and problem.freedom[clusters].sum() >= CONSISTENCY.fewest_residuals
    )


def _compare_parameters(problem: Problem, found: SearchResult, one: RecordingPart, other: RecordingPart) -> str | None:
    """Return how the parameters of a model differ between two recordings, None if not significantly."""
    free = found.law.free
    both = fit(problem, found.law.values, free, np.concatenate([one.clusters, other.clusters]))
    each = [fit(problem, both.values, free, part.clusters) for part in (one, other)]
    separate = sum(some.loss for some in each)
    freedom = sum(problem.freedom[part.clusters].sum() for part in (one, other)) - 2 * len(free)
    if both.loss - separate < CONSISTENCY.harm * max(separate / max(freedom, 1.0), 1.0):
        return None
    return _largest_difference(*each)


def _largest_difference(one: LeastSquaresFit, other: LeastSquaresFit) -> str | None:
    """Return the parameter on which two fits disagree most, None if they do not differ significantly."""
    largest, reason = CONSISTENCY.deviations, None
    for k, name in enumerate(one.free):
        a, b = float(one.values[name]), float(other.values[name])
        deviations = abs(a - b) / max(float(np.sqrt(one.covariance[k, k] + other.covariance[k, k])), 1e-12)
        if deviations > largest and abs(a - b) > CONSISTENCY.relative * max(abs(a), abs(b)):
            largest, reason = deviations, f"{name} is {a:.3g} in the first and {b:.3g} in the second"
    return reason


def _compare_smooth_terms(
    problem: Problem, found: SearchResult, one: RecordingPart, other: RecordingPart
) -> str | None:
    """Return that no common smooth term fits two recordings, None if one does.

    It compares losses, since single coefficients of a smooth term have no meaning.
    """
    both = _losses(problem, found, np.concatenate([one.clusters, other.clusters]))
    each = _losses(problem, found, one.clusters) + _losses(problem, found, other.clusters)
    for part in (one, other):
        shared, own = both[part.clusters].sum(), each[part.clusters].sum()
        if shared - own > CONSISTENCY.harm * found.dispersion and shared > CONSISTENCY.worse_unlisted * own:
            return f"no common {problem.regime} correction fits both"
    return None


def _does_not_transfer(problem: Problem, found: SearchResult, clusters: np.ndarray, part: RecordingPart) -> str | None:
    """Return why the model of `clusters` is not one of the recording `part`, None if it may be.

    It is not if it fits `part` worse than the baseline does, or if it explains `clusters` to the noise and not `part`,
    even with parameters refitted there.
    """
    if _harms(problem, found, part.clusters):
        return f"the {problem.regime} correction that the first supports increases the residuals of the second"
    explained = _own_loss(problem, found, clusters) < CONSISTENCY.explained * problem.freedom[clusters].sum()
    if explained and _is_unexplained(problem, found, part.clusters):
        return f"the {problem.regime} model of the first does not fit the second"
    return None


def _is_unexplained(problem: Problem, found: SearchResult, clusters: np.ndarray) -> bool:
    """Return whether a model leaves more of `clusters` than noise, and of many still does without any one of them.

    One launch may have been disturbed, by a hand near a wall for example; another table shows in more than one.
    """

    def is_left(some: np.ndarray) -> bool:
        allowed = CONSISTENCY.unexplained * problem.freedom[some].sum() + CONSISTENCY.harm
        return bool(_own_loss(problem, found, some) > allowed)

    many = len(clusters) >= CONSISTENCY.fewest_launches
    return is_left(clusters) and (not many or all(is_left(clusters[clusters != one]) for one in clusters))


def _harms(problem: Problem, found: SearchResult, clusters: np.ndarray) -> bool:
    """Return whether listed laws found elsewhere increase the loss of `clusters`, with the baseline refitted."""
    if not found.listed:
        return False
    without_laws = {**found.law.values, **{row: BY_NAME[row].default for law in found.listed for row in law.rows}}
    with_them, baseline = (
        fit(problem, values, problem.base, clusters).loss for values in (found.law.values, without_laws)
    )
    harm = with_them - baseline
    return with_them > CONSISTENCY.worse * baseline and harm > CONSISTENCY.harm * found.dispersion


def _own_loss(problem: Problem, found: SearchResult, clusters: np.ndarray) -> float:
    """Return the robust loss of `clusters` under a model whose parameters are fitted to them."""
    if found.unlisted:
        return float(_losses(problem, found, clusters).sum())
    return fit(problem, found.law.values, found.law.free, clusters).loss


def _losses(problem: Problem, found: SearchResult, clusters: np.ndarray) -> np.ndarray:
    """Return the robust losses (all clusters,) of `clusters` under a smooth term fitted to them; zeros elsewhere."""
    assert found.unlisted is not None
    spread = found.model.spreads[found.model.laws.index(found.unlisted)]
    equations, units = found.columns.equations, problem.units.of(clusters)
    index, ridge = Model(found.law.free, (found.unlisted,), (spread,)).columns(equations)
    freedom = problem.units.freedom[units]
    theta = normal_equations.solve_robustly(equations, index, units, freedom, ridge)
    of_units = group_loss(normal_equations.losses(equations, index, theta, units), freedom)
    return np.bincount(problem.units.cluster[units], of_units, problem.clusters)
