"""Cross-validation over launches: a law is rejected if it does not improve the prediction of held-out launches.

Each launch is predicted with parameters fitted to the launches of the other folds. The holdout, on which the final
model is proved, is not part of these launches (`split`, `prove`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.least_squares import LeastSquaresFit, robust_loss
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.model_search import SearchResult, without, without_laws
from sim2real.diagnose.engine.problem import Problem, Residuals
from sim2real.diagnose.engine.tuned import ENGINE
from sim2real.diagnose.tuned import RESIDUALS
from sim2real.statistics.robust import group_loss


@dataclass(frozen=True)
class Selection:
    """The selected model.

    `found`: the search result without the laws that were `rejected` and without `others`, which were dropped because
    of that; `without`: for each law of its model, by name, the result without it; `small`: size [m] by name of laws
    that are significant, but too small to report; `cross_validation`: losses of all of these.
    """

    cross_validation: CrossValidation
    found: SearchResult
    without: dict[str, SearchResult]
    rejected: tuple[Law, ...] = ()
    others: tuple[Law, ...] = ()
    small: Mapping[str, float] = field(default_factory=dict)


def select(problem: Problem, found: SearchResult, clear: bool = True) -> Selection:
    """Reject the laws that cross-validation over launches does not support, the most harmful first.

    If laws are rejected and most of the excess residual remains, the other laws are dropped too, since they probably
    approximate the same missing law. `clear`: whether the regimes that this one depends on are explained; if not, a law
    to which the launches are insensitive is rejected.
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
    if not validation.supports(found, without_laws(found), found.model.laws, clear):
        return Selection(validation, without_laws(found), {}, (*rejected, *found.model.laws))
    if rejected and validation.leaves_most(found):
        return Selection(validation, without_laws(found), {}, tuple(rejected), found.model.laws)
    return Selection(validation, found, others, tuple(rejected))


class CrossValidation:
    """Losses of launches, each predicted with parameters from the other folds: one Gauss-Newton step from the full fit.

    A loss is the sum of the `group_loss` of parts (units if single ones may be outliers, else launches), divided by
    `dispersion`, the variance of the noise in units of the sensor's. No single launch or contact can dominate it.
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
        """Return the rms cross-validation residual, in units of the sensor's noise."""
        return float(np.sqrt(self._squares(found).sum() / max(self._freedom.sum() / self._dispersion, 1.0)))

    def loss(self, found: SearchResult) -> np.ndarray:
        """Return the cross-validation loss (launches,)."""
        return np.bincount(self._launch, self._robust_losses(self._squares(found)), len(self.launches))

    def gained(self, found: SearchResult, other: SearchResult) -> np.ndarray:
        """Return the loss (launches,) of the `other` minus that of `found`."""
        return self.loss(other) - self.loss(found)

    def supports(self, found: SearchResult, other: SearchResult, laws: tuple[Law, ...], clear: bool) -> bool:
        """Return whether launches support the `laws` that `found` has and the `other` has not, or do not refute them.

        The gain must exceed a share of the excess of `found` over the noise. Launches are no evidence on coefficients
        that each launch has of its own, nor on listed laws to which they are insensitive; those are accepted if all
        else is `clear`. A smooth term is an approximation and may fail where data are sparse: if launches confirm the
        model, the term is rejected only if it increases the loss by more than the scatter of launches.
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
        """Return whether the loss is far beyond noise and the laws explain less than most of the baseline's excess."""
        large = float(self._robust_losses(RESIDUALS.large**2 * self._freedom).sum())
        baseline, remaining = (float(self.loss(one).sum()) for one in (without_laws(found), found))
        noise = float(self._freedom.sum()) / self._dispersion
        return remaining > large and baseline - remaining < ENGINE.proving_share * (baseline - noise)

    def _robust_losses(self, squares: np.ndarray) -> np.ndarray:
        return group_loss(squares, self._freedom) / self._dispersion

    def _squares(self, found: SearchResult) -> np.ndarray:
        """Return the sums of squares (parts,), each part predicted from the other folds; cached by result."""
        if id(found) not in self._computed:
            self._computed[id(found)] = (
                found,
                self._predicted_squares(found),
            )  # holds a reference, so that no other object gets the same id
        return self._computed[id(found)][1]

    def _predicted_squares(self, found: SearchResult) -> np.ndarray:
        if found.unlisted is None:
            rows = self._problem.residuals(found.law.values, found.law.free, self.launches)
            return self._summed(self._predicted(found.law, rows), rows)
        units = self._problem.units.of(self.launches)
        squares = np.bincount(units, self._predicted_with_term(found, units), len(self._problem.units.cluster))
        if not self._by_unit:
            squares = np.bincount(self._problem.units.cluster, squares, self._problem.clusters)
        return squares[self._parts]

    def _predicted(self, law: LeastSquaresFit, rows: Residuals) -> np.ndarray:
        """Return residuals (n,), each after the Gauss-Newton step that the other folds give.

        The step moves the free parameters that are not at a bound. It is omitted if it increases the loss of those
        folds, as at the edge of a patch.
        """
        moving = [name for name in law.free if name not in law.bound]
        jacobian, residuals = rows.jacobian[:, [law.free.index(name) for name in moving]], rows.r.copy()
        weight, fold = robust_loss(self._problem, rows)[1], self._fold[rows.cluster]
        for out in range(ENGINE.launch_folds) if moving else ():
            inside = fold != out
            inner, rest = weight[inside, None] * jacobian[inside], weight[inside] * rows.r[inside]
            step = -normal_equations.solve_normal(inner.T @ inner, inner.T @ rest)
            values = {name: BY_NAME[name].within(law.values[name] + by) for name, by in zip(moving, step, strict=True)}
            stepped = self._problem.residuals({**law.values, **values}, (), self.launches).r
            if np.sum((weight[inside] * stepped[inside]) ** 2) < np.sum(rest**2):
                residuals[~inside] = stepped[~inside]
        return residuals

    def _predicted_with_term(self, found: SearchResult, units: np.ndarray) -> np.ndarray:
        """Return the sums of squares (units,) with a smooth term added, each unit predicted from the other folds."""
        assert found.smooth is not None
        if found.smooth.family.each_launch:
            return found.losses(found.columns.equations, found.smooth.family, units)
        equations, freedom = found.smooth.columns.equations, self._problem.units.freedom
        columns, ridge = found.smooth.model.columns(equations)
        fold, squares = self._fold[self._problem.units.cluster[units]], np.zeros(len(units))
        for out in range(ENGINE.launch_folds):
            fitted, tested = units[fold != out], units[fold == out]
            theta = normal_equations.solve_robustly(
                equations, columns, fitted, freedom[fitted] * self._dispersion, ridge
            )
            squares[fold == out] = normal_equations.losses(equations, columns, theta, tested)
        return squares

    def _effect(self, one: SearchResult, other: SearchResult) -> float:
        """Return the robust loss of the difference between the predictions of two fits."""
        rows = [self._problem.residuals(each.law.values, (), self.launches) for each in (one, other)]
        return float(self._robust_losses(self._summed(rows[0].r - rows[1].r, rows[0])).sum())

    def _summed(self, residuals: np.ndarray, rows: Residuals) -> np.ndarray:
        """Return the squares of `residuals` (n,), summed by part (parts,)."""
        part = rows.cluster if rows.unit is None else rows.unit
        return np.bincount(part, residuals**2, self._parts.max(initial=-1) + 1)[self._parts]
