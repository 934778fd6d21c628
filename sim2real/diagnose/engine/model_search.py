"""The search for missing laws of a regime: refit the baseline, select laws, fit them jointly, test the remainder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine.backward_elimination import (
    defaults_accepted,
    eliminated,
    has_misfit,
    refit,
    without_leverage,
    without_outliers,
)
from sim2real.diagnose.engine.candidate_models import CandidateModel, best_candidate, identifiable
from sim2real.diagnose.engine.forward_selection import ForwardSelection, Gain
from sim2real.diagnose.engine.further_laws import with_further_laws
from sim2real.diagnose.engine.law import Law, Model
from sim2real.diagnose.engine.least_squares import LeastSquaresFit, fit, given
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.linear.dispersion import estimated_dispersion
from sim2real.diagnose.engine.linear.normal_equations import NormalEquations
from sim2real.diagnose.engine.nonparametric import NonparametricFit, fit_nonparametric
from sim2real.diagnose.engine.problem import DesignMatrix, Problem
from sim2real.diagnose.engine.tuned import ENGINE


@dataclass(frozen=True, kw_only=True)
class SearchResult:
    """The result of a search.

    `baseline`: fit without laws. `model`: the laws, as `forward_selection` chose them in the design matrix `screen`.
    `law`: joint fit of the baseline and the listed laws; with a smooth term `smooth` added, the parameters about which
    that was linearized. `theta_covariance`: of `theta`. `clusters`: those that were fitted. `defaults`: whether the
    default parameters agree with the data. `dispersion`: variance of the noise in units of the sensor's.
    `inconclusive`: a law that too few launches support. `misfit`: whether residuals remain that no law explains.
    """

    baseline: LeastSquaresFit
    model: Model
    law: LeastSquaresFit
    smooth: NonparametricFit | None
    theta_covariance: np.ndarray
    clusters: np.ndarray
    defaults: bool
    dispersion: float
    screen: DesignMatrix
    forward_selection: ForwardSelection
    inconclusive: Law | None
    misfit: bool

    @property
    def listed(self) -> tuple[Law, ...]:
        """The listed laws of the model."""
        return tuple(one for one in self.model.laws if not one.family)

    @property
    def unlisted(self) -> Law | None:
        """The smooth term added to them, if any."""
        return self.smooth.family if self.smooth else None

    @property
    def theta(self) -> np.ndarray:
        """Steps (n,) of the law's free parameters and coefficients (k,) of the smooth term; empty without one."""
        return self.smooth.theta if self.smooth else np.zeros(0)

    @property
    def columns(self) -> DesignMatrix:
        """The design matrix about the final law."""
        return self.smooth.columns if self.smooth else self.screen

    @property
    def final(self) -> LeastSquaresFit:
        """The fit of the baseline and the listed laws, jointly with the smooth term if there is one."""
        if self.unlisted is None:
            return self.law
        values = dict(self.law.values)
        for k, name in enumerate(self.law.free):
            values[name] = BY_NAME[name].within(values[name] + float(self.theta[k]))
        n = len(self.law.free)
        return replace(self.law, values=values, covariance=self.theta_covariance[:n, :n])

    @property
    def coefficients(self) -> np.ndarray:
        """The coefficients (k,) of the smooth term."""
        return self.theta[len(self.law.free) :]

    @property
    def all_values(self) -> Mapping[str, float]:
        """All parameters by name, with those of the smooth term if the simulator can represent it."""
        return {**self.final.values, **self.effect_parameters()}

    def gained(self, parts: np.ndarray) -> float:
        """Return the reduction of the sum of squares of units by the smooth term, fitted with its ridge penalty."""
        assert self.unlisted is not None
        spread = self.model.spreads[self.model.laws.index(self.unlisted)]
        squares = []
        for model in (Model(self.law.free), Model(self.law.free, (self.unlisted,), (spread,))):
            columns, ridge = model.columns(self.columns.equations)
            theta = normal_equations.solve(self.columns.equations, columns, parts, ridge)
            squares.append(float(normal_equations.losses(self.columns.equations, columns, theta, parts).sum()))
        return squares[0] - squares[1]

    def losses(self, equations: NormalEquations, family: Law, parts: np.ndarray) -> np.ndarray:
        """Return the sums of squares (parts,) of units of `equations` under the law with its smooth term.

        `family`: the term with the columns that it has in these equations. Coefficients that each launch has of its own
        are fitted to every second unit and tested on the others.
        """
        index, _ = Model(self.law.free, (family,), (1.0,)).columns(equations)
        if not family.each_launch:
            return normal_equations.losses(equations, index, self.theta, parts)
        n = len(self.law.free)
        stepped = normal_equations.moved(equations, equations.columns(self.law.free), self.theta[:n])
        squares, odd = np.zeros(len(parts)), np.arange(len(parts)) % 2 == 1
        for tested in (odd, ~odd):
            own = normal_equations.solve(stepped, equations.columns(family.columns), parts[~tested])
            theta = np.concatenate([self.theta[:n], own])
            squares[tested] = normal_equations.losses(equations, index, theta, parts[tested])
        return squares

    def effect_parameters(self) -> Mapping[str, float]:
        """Return the simulator's parameters of the smooth term; empty if it cannot represent the term."""
        if self.unlisted is None:
            return {}
        law = next(one for one in self.columns.families if one.name == self.unlisted.name)
        return law.switch(self.coefficients)


def search_model(
    problem: Problem,
    defaults: Mapping[str, float],
    use: np.ndarray,
    clear: bool = True,
    dispersion: float | None = None,
) -> SearchResult:
    """Search the clusters `use` of a problem for missing laws, starting from the default parameters `defaults`.

    `clear`: whether the regimes that this one depends on are explained, so that a misfit is its own and smooth terms
    may be tried. `dispersion`: variance of the noise in units of the sensor's; if None, the richest model estimates it.
    """
    first = given(defaults)
    if problem.first_fitted != problem.base:
        first = fit(problem, defaults, problem.first_fitted, use)
    use, baseline = without_leverage(problem, fit(problem, first.values, problem.base, use), use)
    every = problem.columns(baseline.values, (), use)
    screen = identifiable(every, problem, use)
    laws = [*screen.listed, *screen.families]
    dispersion = dispersion or estimated_dispersion(screen.equations, problem.units, problem.base, laws, use)
    selection = ForwardSelection(screen.equations, problem.units, use, dispersion, _least_gain(problem))
    grown = selection.add_forward(Model(problem.base), screen.listed, ENGINE.most_listed)
    listed, law = eliminated(problem, baseline, selection.eliminate_backward(grown), screen, use)
    listed, law = with_further_laws(problem, baseline, listed, law, screen, selection, use)
    best = CandidateModel(listed, law, None, np.inf)
    if clear:
        best = best_candidate(problem, baseline, law, listed, selection, screen, every.families, use)
    model, law, smooth = best.model, best.law, best.smooth
    kept = use if smooth else without_outliers(problem, law, use)
    if len(kept) < len(use):
        baseline = fit(problem, baseline.values, problem.base, kept)
        law = refit(problem, baseline, [one for one in model.laws if not one.family], screen, kept)
    gains = selection.gains(model, screen.listed) if clear else []
    return SearchResult(
        baseline=baseline,
        model=model,
        law=law,
        smooth=smooth,
        theta_covariance=_covariance(problem, smooth, use),
        clusters=kept,
        defaults=defaults_accepted(problem, defaults, baseline, kept, dispersion),
        dispersion=dispersion,
        screen=screen,
        forward_selection=selection,
        inconclusive=_inconclusive(selection, gains),
        misfit=clear and not model.laws and has_misfit(problem, baseline, law, use),
    )


def without(problem: Problem, found: SearchResult, law: Law) -> SearchResult:
    """Return the result without one of its laws: the remaining model refitted to the same clusters."""
    model = found.model.minus(law)
    fitted, smooth = found.baseline, None
    if any(not one.family for one in model.laws):
        removed = () if law.family else law.rows
        values = {**found.law.values, **{name: BY_NAME[name].default for name in removed}}
        fitted = fit(problem, values, [name for name in found.law.free if name not in removed], found.clusters)
    if found.unlisted is not None and not law.family:
        smooth = fit_nonparametric(problem, fitted, found.unlisted, found.clusters, found.dispersion)
        fitted, model = smooth.law, model.minus(found.unlisted).plus(smooth.family, smooth.spread)
    spread = _covariance(problem, smooth, found.clusters)
    return replace(found, model=model, law=fitted, smooth=smooth, theta_covariance=spread)


def without_laws(found: SearchResult) -> SearchResult:
    """Return the result without laws: the baseline."""
    model = Model(found.model.base)
    none = np.zeros((0, 0))
    return replace(found, model=model, law=found.baseline, smooth=None, theta_covariance=none, inconclusive=None)


def _covariance(problem: Problem, smooth: NonparametricFit | None, use: np.ndarray) -> np.ndarray:
    return smooth.covariance(problem, use) if smooth else np.zeros((0, 0))


def _least_gain(problem: Problem) -> float:
    """Return the reduction of the loss that a law must exceed where a calibrated camera's map has errors.

    It is the square of twice their size in units of the noise. Where the puck's outline crosses a line of the table,
    some positions are wrong by half of that.
    """
    if not problem.place_error_m:
        return 0.0
    return (ENGINE.calibration_errors * problem.place_error_m / problem.noise_m) ** 2


def _inconclusive(selection: ForwardSelection, gains: Sequence[Gain]) -> Law | None:
    """Return the law that fits best among those that too few launches support."""
    some = [gain for gain in gains if selection.inconclusive(gain)]
    return max(some, key=lambda gain: gain.fitted).law if some else None
