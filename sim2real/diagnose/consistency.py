"""Test whether the recordings of one call are of one table: common parameters against separate ones (Chow, 1960).

The test uses every model that the recordings support, alone or together. Physics that is missing in both recordings, or
that affected one by chance, is therefore not taken for another table.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine.law import Model
from sim2real.diagnose.engine.least_squares import LeastSquaresFit, fit, launch_losses
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
    fits = _Fits(problem)
    for clusters in training_sets:
        found = search_model(problem, defaults, clusters)
        if found.unlisted:
            differing = _differ_in_smooth_term(problem, found, parts)
        else:
            differing = _differ_in_parameters(fits, found, parts)
        if differing:
            raise two_tables(*differing)
        for part in parts:
            why = _does_not_transfer(fits, found, clusters, part)
            if why:
                first = next((one.name for one in parts if np.array_equal(one.clusters, clusters)), "the others")
                raise two_tables(first, part.name, why)


@dataclass(frozen=True)
class _Fits:
    """Fits of parameters to parts of a problem, each made once: most recordings support the same parameters."""

    problem: Problem
    made: dict[tuple[tuple[str, ...], bytes], LeastSquaresFit] = field(default_factory=dict)

    def of(self, values: Mapping[str, float], free: Sequence[str], clusters: np.ndarray) -> LeastSquaresFit:
        """Return the fit of `free` to `clusters`; `values`: where it starts, the others at their defaults."""
        key = (tuple(free), clusters.tobytes())
        if key not in self.made:
            self.made[key] = fit(self.problem, values, free, clusters)
        return self.made[key]

    def better(self, others: Sequence[LeastSquaresFit], clusters: np.ndarray) -> LeastSquaresFit:
        """Return the fit to `clusters` again, or one of less loss that starts from `others`, of the same parameters.

        A robust loss has more minima than one: contacts that a fit took for outliers do not lead it to where they
        would fit. From then on `of` returns this one.
        """
        key = (others[0].free, clusters.tobytes())
        again = [fit(self.problem, other.values, other.free, clusters) for other in others]
        self.made[key] = min([self.made[key], *again], key=lambda made: made.loss)
        return self.made[key]


def _enough(problem: Problem, clusters: np.ndarray) -> bool:
    return (
        len(clusters) >= CONSISTENCY.fewest_launches and problem.freedom[clusters].sum() >= CONSISTENCY.fewest_residuals
    )


def _differ_in_parameters(
    fits: _Fits, found: SearchResult, parts: Sequence[RecordingPart]
) -> tuple[str, str, str] | None:
    """Return two recordings between which the parameters of a model differ significantly, and how; None if there are
    none.

    No two recordings lose more by common parameters than all of them together do: each fit starts from the common one.
    Where these lose much, that is tried from where each recording leads, too, and each recording from there. One launch
    may have been disturbed: two tables differ without the one that speaks most for it, too.
    """
    every = np.concatenate([part.clusters for part in parts])
    common = fits.of(found.law.values, found.law.free, every)

    def fitted(*some: RecordingPart) -> LeastSquaresFit:
        return fits.of(common.values, found.law.free, np.concatenate([part.clusters for part in some]))

    def is_shared() -> bool:
        return common.loss - sum(fitted(part).loss for part in parts) < CONSISTENCY.harm

    if is_shared():
        return None
    common = fits.better([fitted(part) for part in parts], every)
    for part in parts:
        fits.better([common], part.clusters)
    if is_shared():
        return None
    for one, other in combinations(parts, 2):
        pair = one.clusters, other.clusters
        why = _difference(fits, common, *pair)
        if why:
            disturbed = _speaks_most(fits, common, *pair)
            why = _difference(fits, common, *(clusters[clusters != disturbed] for clusters in pair))
        if why:
            return one.name, other.name, why
    return None


def _difference(fits: _Fits, common: LeastSquaresFit, one: np.ndarray, other: np.ndarray) -> str | None:
    """Return how the parameters differ between the launches of two recordings, None if not significantly; `common`:
    where the fits start."""
    own = [fits.of(common.values, common.free, clusters) for clusters in (one, other)]
    both = np.concatenate([one, other])
    separate = sum(each.loss for each in own)
    freedom = fits.problem.freedom[both].sum() - 2 * len(common.free)
    harm = fits.of(common.values, common.free, both).loss - separate
    if harm < CONSISTENCY.harm * max(separate / max(freedom, 1.0), 1.0):
        return None
    return _largest_difference(*own)


def _speaks_most(fits: _Fits, common: LeastSquaresFit, one: np.ndarray, other: np.ndarray) -> int:
    """Return the launch of two recordings whose loss is reduced most by parameters of their own."""

    def losses(*some: np.ndarray) -> np.ndarray:
        clusters = np.concatenate(some)
        return launch_losses(fits.problem, fits.of(common.values, common.free, clusters).values, clusters)

    return int(np.argmax(losses(one, other) - losses(one) - losses(other)))


def _largest_difference(one: LeastSquaresFit, other: LeastSquaresFit) -> str | None:
    """Return the parameter on which two fits disagree most, None if they do not differ significantly."""
    largest, reason = CONSISTENCY.deviations, None
    for k, name in enumerate(one.free):
        a, b = float(one.values[name]), float(other.values[name])
        deviations = abs(a - b) / max(float(np.sqrt(one.covariance[k, k] + other.covariance[k, k])), 1e-12)
        if deviations > largest and abs(a - b) > CONSISTENCY.relative * max(abs(a), abs(b)):
            largest, reason = deviations, f"{name} is {a:.3g} in the first and {b:.3g} in the second"
    return reason


def _differ_in_smooth_term(
    problem: Problem, found: SearchResult, parts: Sequence[RecordingPart]
) -> tuple[str, str, str] | None:
    """Return two recordings that no common smooth term fits, and that as the reason; None if there are none.

    It compares losses, since single coefficients of a smooth term have no meaning. A recording that the common term
    explains to the noise does not contradict the others, however much less its own would leave of it.
    """
    own = np.sum([_losses(problem, found, part.clusters) for part in parts], axis=0)
    for pair in combinations(parts, 2):
        both = _losses(problem, found, np.concatenate([part.clusters for part in pair]))
        for part in pair:
            shared, alone = both[part.clusters].sum(), own[part.clusters].sum()
            if shared < CONSISTENCY.explained * problem.freedom[part.clusters].sum():
                continue
            if shared - alone > CONSISTENCY.harm * found.dispersion and shared > CONSISTENCY.worse_unlisted * alone:
                return pair[0].name, pair[1].name, f"no common {problem.regime} correction fits both"
    return None


def _does_not_transfer(fits: _Fits, found: SearchResult, clusters: np.ndarray, part: RecordingPart) -> str | None:
    """Return why the model of `clusters` is not one of the recording `part`, None if it may be.

    It is not if it fits `part` worse than the baseline does, or if it explains `clusters` to the noise and not `part`,
    even with parameters refitted there.
    """
    problem = fits.problem
    if _harms(fits, found, part.clusters):
        return f"the {problem.regime} correction that the first supports increases the residuals of the second"
    explained = _own_loss(fits, found, clusters) < CONSISTENCY.explained * problem.freedom[clusters].sum()
    if explained and _is_unexplained(fits, found, part.clusters):
        return f"the {problem.regime} model of the first does not fit the second"
    return None


def _is_unexplained(fits: _Fits, found: SearchResult, clusters: np.ndarray) -> bool:
    """Return whether a model leaves more of `clusters` than noise, and of many still does without any one of them.

    One launch may have been disturbed, by a hand near a wall for example; another table shows in more than one.
    """

    def is_left(some: np.ndarray) -> bool:
        allowed = CONSISTENCY.unexplained * fits.problem.freedom[some].sum() + CONSISTENCY.harm
        return bool(_own_loss(fits, found, some) > allowed)

    many = len(clusters) >= CONSISTENCY.fewest_launches
    return is_left(clusters) and (not many or all(is_left(clusters[clusters != one]) for one in clusters))


def _harms(fits: _Fits, found: SearchResult, clusters: np.ndarray) -> bool:
    """Return whether listed laws found elsewhere increase the loss of `clusters`, with the baseline refitted."""
    if not found.listed:
        return False
    base = fits.problem.base
    without_laws = {**found.law.values, **{row: BY_NAME[row].default for law in found.listed for row in law.rows}}
    with_them = fit(fits.problem, found.law.values, base, clusters).loss  # those of `found`, so no fit of `_Fits`
    baseline = fits.of(without_laws, base, clusters).loss
    harm = with_them - baseline
    return with_them > CONSISTENCY.worse * baseline and harm > CONSISTENCY.harm * found.dispersion


def _own_loss(fits: _Fits, found: SearchResult, clusters: np.ndarray) -> float:
    """Return the robust loss of `clusters` under a model whose parameters are fitted to them."""
    if found.unlisted:
        return float(_losses(fits.problem, found, clusters).sum())
    return fits.of(found.law.values, found.law.free, clusters).loss


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
