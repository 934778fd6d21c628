"""Nonparametric fits: a smooth term of the basis library added to a law, linearized about the trajectory of both.

Ridge regression on basis functions: the coefficients have a normal prior about 0, whose standard deviation (`spread`)
cross-validation chooses.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine.forward_selection import ForwardSelection
from sim2real.diagnose.engine.law import Law, Model
from sim2real.diagnose.engine.least_squares import LeastSquaresFit
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.problem import DesignMatrix, Problem
from sim2real.diagnose.engine.tuned import ENGINE
from sim2real.statistics.robust import group_loss


@dataclass(frozen=True)
class NonparametricFit:
    """A smooth term `family` added to `law`.

    `theta` (n + k,): steps of the law's n free parameters, then the term's k coefficients. `columns`: the design matrix
    of `theta`, whose residuals are those without the term wherever it was linearized. `spread`: the prior standard
    deviation of the coefficients; `cv_loss`: the cross-validation loss.
    """

    law: LeastSquaresFit
    family: Law
    spread: float
    columns: DesignMatrix
    theta: np.ndarray
    cv_loss: float

    @property
    def model(self) -> Model:
        """The law's free parameters and the smooth term."""
        return Model(self.law.free, (self.family,), (self.spread,))

    def covariance(self, problem: Problem, use: np.ndarray) -> np.ndarray:
        """Return the covariance (n + k, n + k) of `theta`, from the clusters `use` that were fitted."""
        launches = normal_equations.gathered(self.columns.equations, problem.units.cluster, problem.clusters)
        columns, ridge = self.model.columns(self.columns.equations)
        freedom = float(problem.freedom[use].sum())
        return normal_equations.covariance(launches, columns, self.theta, use, freedom, ridge)


def fit_nonparametric(
    problem: Problem, law: LeastSquaresFit, family: Law, use: np.ndarray, dispersion: float
) -> NonparametricFit:
    """Fit `family` added to `law` to the clusters `use`; `dispersion`: variance of the noise in units of the sensor's.

    If the simulator can represent a nonlinear term, Gauss-Newton linearizes anew about the trajectory with it until no
    step lowers the loss; otherwise the term is linearized once, about the trajectory without it. If no step of a term
    lowers the loss, its `cv_loss` is infinite.
    """
    search = _Search(problem, use, dispersion)
    here = search.linearized(law, family, np.zeros(len(family.columns)))
    best = search.solved(here)
    if family.linear or not family.switch(best.theta[len(law.free) :]):
        return best
    cv_loss = np.inf
    for _ in range(ENGINE.term_rounds):
        there = search.downhill(here, best)
        if there is None:
            return replace(best, theta=np.concatenate([np.zeros(len(law.free)), here.coefficients]), cv_loss=cv_loss)
        cv_loss, now, then = best.cv_loss, search.loss(here, best.spread), search.loss(there, best.spread)
        here, best = there, search.solved(there)
        if now - then < ENGINE.term_decrease * now:
            break
    return best


@dataclass(frozen=True)
class _Linearization:
    """The design matrix about the trajectory of a law with `coefficients` (k,) of a smooth term.

    Its residuals are those without the term.
    """

    law: LeastSquaresFit
    family: Law
    coefficients: np.ndarray
    columns: DesignMatrix


def _may_move(law: LeastSquaresFit, name: str, step: float) -> bool:
    """Whether a parameter is not at a bound of its range already beyond which a step would take it."""
    now = law.values[name]
    return step == 0.0 or BY_NAME[name].within(now + step) != now


class _Search:
    """Gauss-Newton steps on the clusters `use`."""

    def __init__(self, problem: Problem, use: np.ndarray, dispersion: float) -> None:
        self._problem, self._use, self._dispersion = problem, use, dispersion
        self._units = problem.units.of(use)
        self._freedom = problem.units.freedom[self._units] * dispersion

    def linearized(self, law: LeastSquaresFit, family: Law, coefficients: np.ndarray) -> _Linearization:
        """Return the linearization about the trajectory of the law with these coefficients of the term."""
        values: Mapping[str, float] = {**law.values, **(family.switch(coefficients) if coefficients.any() else {})}
        columns = self._problem.columns(values, law.free, None, only=[family])
        family = columns.families[0]
        index = columns.equations.columns(family.columns)
        without = normal_equations.moved(columns.equations, index, -coefficients)
        return _Linearization(law, family, coefficients, replace(columns, equations=without))

    def loss(self, here: _Linearization, spread: float) -> float:
        """Return the robust loss at a linearization plus the penalty sum(coefficients²) / spread²."""
        index = here.columns.equations.columns(here.family.columns)
        squares = normal_equations.losses(here.columns.equations, index, here.coefficients, self._units)
        return float(group_loss(squares, self._freedom).sum() + np.sum(here.coefficients**2) / spread**2)

    def solved(self, here: _Linearization) -> NonparametricFit:
        """Return the robust least-squares fit at a linearization, with the spread of least cross-validation loss; a
        parameter at a bound, beyond which the fit would take it, stays there."""
        equations = here.columns.equations
        selection = ForwardSelection(equations, self._problem.units, self._use, self._dispersion)
        free = here.law.free
        while True:
            models = [Model(free, (here.family,), (spread,)) for spread in ENGINE.spreads]
            cv_loss = [float(selection.cv_loss(model).sum()) for model in models]
            best = int(np.argmin(cv_loss))
            index, ridge = models[best].columns(equations)
            theta = normal_equations.solve_robustly(equations, index, self._units, self._freedom, ridge)
            inside = tuple(name for name, step in zip(free, theta, strict=False) if _may_move(here.law, name, step))
            if inside == free:
                break
            free = inside  # for this step; the next, about another trajectory, may move it again
        steps = dict(zip(free, theta[: len(free)], strict=True))
        every = np.concatenate([[steps.get(name, 0.0) for name in here.law.free], theta[len(free) :]])
        return NonparametricFit(here.law, here.family, ENGINE.spreads[best], here.columns, every, cv_loss[best])

    def downhill(self, here: _Linearization, step: NonparametricFit) -> _Linearization | None:
        """Return the linearization after a step, shortened until it lowers the loss; None if no step does."""
        n = len(here.law.free)
        now = self.loss(here, step.spread)
        for length in 0.5 ** np.arange(ENGINE.term_halvings):
            values = dict(here.law.values)
            for name, change in zip(here.law.free, length * step.theta[:n], strict=True):
                values[name] = BY_NAME[name].within(values[name] + change)
            coefficients = here.coefficients + length * (step.theta[n:] - here.coefficients)
            there = self.linearized(replace(here.law, values=values), here.family, coefficients)
            if self.loss(there, step.spread) < now:
                return there
        return None
