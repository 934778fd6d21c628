"""Cross-validation over launches: a law that predicts launches no better than its absence does is rejected.

Each launch is predicted by parameters fitted to the launches of other folds. The holdout launches, by which the final
model is proved, are none of these: they are not at hand here (`split`, `prove`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine import normal_equations
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.least_squares import LeastSquaresFit, robust_loss
from sim2real.diagnose.engine.model_search import SearchResult, bare, without
from sim2real.diagnose.engine.problem import Problem, Residuals
from sim2real.diagnose.engine.tuned import ENGINE
from sim2real.diagnose.result.result import MUCH
from sim2real.statistics.robust import group_loss


@dataclass(frozen=True)
class Selection:
    """What is selected: `found` without the laws that were `rejected`, and without `others`, which are not believed
    beside them; for each law of its model, by name, the result `without` it. `small`: by name, the size [m] of laws
    that are significant, but too small to matter. `cross_validation`: of all of these."""

    cross_validation: CrossValidation
    found: SearchResult
    without: dict[str, SearchResult]
    rejected: tuple[Law, ...] = ()
    others: tuple[Law, ...] = ()
    small: Mapping[str, float] = field(default_factory=dict)


def select(problem: Problem, found: SearchResult, clear: bool = True) -> Selection:
    """Reject the laws that cross-validation over launches does not support, the most harmful first. Where laws are
    rejected and most remains unexplained, the others go too, since they stood in for something as well.

    `clear`: whether the regimes that this one rests on are explained; if not, a law that launches do not feel goes.
    """
    validation, rejected = CrossValidation(problem, found.dispersion), []
    while found.model.laws:
        others = {law.name: without(problem, found, law) for law in found.model.laws}
        refuted = [law for law in found.model.laws if not validation.supports(found, others[law.name], (law,), clear)]
        if not refuted:
            break
        worst = min(refuted, key=lambda law: validation.gained(found, others[law.name]).sum())
        found, rejected = others[worst.name], [*rejected, worst]
    if not found.model.laws:
        return Selection(validation, found, {}, tuple(rejected))
    if not validation.supports(found, bare(found), found.model.laws, clear):
        return Selection(validation, bare(found), {}, (*rejected, *found.model.laws))
    if rejected and validation.leaves_most(found):
        return Selection(validation, bare(found), {}, tuple(rejected), found.model.laws)
    return Selection(validation, found, others, tuple(rejected))


class CrossValidation:
    """Losses of launches, each predicted by the parameters that fit the launches of other folds: one step of
    Gauss-Newton from the fit to all.

    A loss is the sum of the `group_loss` of parts (units where single ones may be outliers, else launches), divided by
    `dispersion`, the variance of the noise in units of the sensor's: neither an odd launch nor an odd contact decides.
    """

    def __init__(self, problem: Problem, dispersion: float) -> None:
        self._problem, self._dispersion = problem, dispersion
        self.launches = np.flatnonzero(problem.freedom > 0)
        self._fold = np.zeros(problem.clusters, int)
        self._fold[self.launches] = np.arange(len(self.launches)) % ENGINE.launch_folds
        rows = problem.residuals({}, (), self.launches)
        self._by_unit = rows.unit is not None
        cluster, freedom = np.arange(problem.clusters), problem.freedom
        if self._by_unit:
            cluster, freedom = problem.units.cluster, problem.units.freedom
        self._parts = np.flatnonzero(np.isin(cluster, self.launches) & (freedom > 0.0))
        self._freedom = freedom[self._parts] * dispersion
        self._launch = np.searchsorted(self.launches, cluster[self._parts])
        self._computed: dict[int, tuple[SearchResult, np.ndarray]] = {}

    def rms(self, found: SearchResult) -> float:
        """Rms cross-validation residual, in units of the sensor's noise."""
        return float(np.sqrt(self._squares(found).sum() / max(self._freedom.sum() / self._dispersion, 1.0)))

    def loss(self, found: SearchResult) -> np.ndarray:
        """Cross-validation loss (launches,)."""
        return np.bincount(self._launch, self._robust_losses(self._squares(found)), len(self.launches))

    def gained(self, found: SearchResult, other: SearchResult) -> np.ndarray:
        """How much greater the loss (launches,) of the `other` is."""
        return self.loss(other) - self.loss(found)

    def supports(self, found: SearchResult, other: SearchResult, laws: tuple[Law, ...], clear: bool) -> bool:
        """Whether launches support the `laws` that `found` has and the `other` has not, or at least do not refute them:
        the gain must be a share of what `found` leaves beyond noise.

        Launches say nothing of coefficients that each launch has of its own, nor of listed laws that they hardly feel,
        which stand if all else is `clear`. A smooth term approximates the truth and may fail where hardly any launch
        ever was: if launches confirm the model, it goes only if the loss grows with it by more than launches scatter.
        """
        if any(law.each_launch for law in laws):
            return True
        gained = self.gained(found, other)
        if any(law.family for law in laws):
            if len(gained) > 1 and found.forward_selection.confirmed(found.model):
                return float(gained.sum()) >= -float(np.linalg.norm(gained))
        elif found.unlisted is None and self._effect(found, other) < ENGINE.sensitivity:
            return clear
        excess = float(self.loss(found).sum() - self._freedom.sum() / self._dispersion)
        return float(gained.sum()) > max(ENGINE.share_of_excess * excess, 0.0)

    def leaves_most(self, found: SearchResult) -> bool:
        """Whether the loss is far beyond noise, and laws explain less than most of the baseline's excess."""
        much = float(self._robust_losses(MUCH**2 * self._freedom).sum())
        baseline, left = (float(self.loss(one).sum()) for one in (bare(found), found))
        noise = float(self._freedom.sum()) / self._dispersion
        return left > much and baseline - left < ENGINE.proving_share * (baseline - noise)

    def _robust_losses(self, squares: np.ndarray) -> np.ndarray:
        return group_loss(squares, self._freedom) / self._dispersion

    def _squares(self, found: SearchResult) -> np.ndarray:
        """Sums of squares (parts,), each part predicted by the other folds; computed once a result."""
        if id(found) not in self._computed:
            self._computed[id(found)] = (
                found,
                self._predicted_squares(found),
            )  # kept, so that no other object gets its id
        return self._computed[id(found)][1]

    def _predicted_squares(self, found: SearchResult) -> np.ndarray:
        if found.unlisted is None:
            rows = self._problem.residuals(found.law.values, found.law.free, self.launches)
            return self._summed(self._predicted(found.law, rows), rows)
        units = self._problem.units.of(self.launches)
        left = np.bincount(units, self._predicted_with_term(found, units), len(self._problem.units.cluster))
        if not self._by_unit:
            left = np.bincount(self._problem.units.cluster, left, self._problem.clusters)
        return left[self._parts]

    def _predicted(self, law: LeastSquaresFit, rows: Residuals) -> np.ndarray:
        """Residuals (n,), each after the Gauss-Newton step of the free parameters, but for those at a bound, that the
        other folds take. A step that leads uphill there, as over the edge of a patch, is left out."""
        moving = [name for name in law.free if name not in law.bound]
        jacobian, left = rows.jacobian[:, [law.free.index(name) for name in moving]], rows.r.copy()
        weight, fold = robust_loss(self._problem, rows)[1], self._fold[rows.cluster]
        for out in range(ENGINE.launch_folds) if moving else ():
            inside = fold != out
            inner, rest = weight[inside, None] * jacobian[inside], weight[inside] * rows.r[inside]
            step = -normal_equations.solve_normal(inner.T @ inner, inner.T @ rest)
            values = {name: BY_NAME[name].within(law.values[name] + by) for name, by in zip(moving, step, strict=True)}
            stepped = self._problem.residuals({**law.values, **values}, (), self.launches).r
            if np.sum((weight[inside] * stepped[inside]) ** 2) < np.sum(rest**2):
                left[~inside] = stepped[~inside]
        return left

    def _predicted_with_term(self, found: SearchResult, units: np.ndarray) -> np.ndarray:
        """Sums of squares (units,) with a smooth term on top, each unit predicted by the other folds."""
        assert found.smooth is not None
        if found.smooth.family.each_launch:
            return found.final_losses(units)
        equations, freedom = found.smooth.columns.equations, self._problem.units.freedom
        columns, ridge = found.smooth.model.columns(equations)
        fold, left = self._fold[self._problem.units.cluster[units]], np.zeros(len(units))
        for out in range(ENGINE.launch_folds):
            fitted, tested = units[fold != out], units[fold == out]
            theta = normal_equations.solve_robustly(
                equations, columns, fitted, freedom[fitted] * self._dispersion, ridge
            )
            left[fold == out] = normal_equations.losses(equations, columns, theta, tested)
        return left

    def _effect(self, one: SearchResult, other: SearchResult) -> float:
        """Robust loss of the difference between the predictions of two fits."""
        rows = [self._problem.residuals(each.law.values, (), self.launches) for each in (one, other)]
        return float(self._robust_losses(self._summed(rows[0].r - rows[1].r, rows[0])).sum())

    def _summed(self, left: np.ndarray, rows: Residuals) -> np.ndarray:
        """Squares of residuals `left` (n,) summed by part (parts,)."""
        part = rows.cluster if rows.unit is None else rows.unit
        return np.bincount(part, left**2, self._parts.max(initial=-1) + 1)[self._parts]
