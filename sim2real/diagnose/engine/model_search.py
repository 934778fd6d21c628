"""The search of a regime for missing laws: refit the baseline, select laws, fit them jointly, and see what remains."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine import normal_equations
from sim2real.diagnose.engine.backward_elimination import (
    defaults_accepted,
    eliminated,
    has_misfit,
    refit,
    without_leverage,
    without_outliers,
)
from sim2real.diagnose.engine.candidate_models import CandidateModel, best_candidate, identifiable
from sim2real.diagnose.engine.forward_selection import ForwardSelection, Gain, estimated_dispersion
from sim2real.diagnose.engine.law import Law, Model
from sim2real.diagnose.engine.least_squares import LeastSquaresFit, fit, given
from sim2real.diagnose.engine.nonparametric import NonparametricFit, fit_nonparametric
from sim2real.diagnose.engine.problem import DesignMatrix, Problem
from sim2real.diagnose.engine.tuned import ENGINE


@dataclass(frozen=True, kw_only=True)
class SearchResult:
    """What a search found.

    `baseline`: fit without laws. `model`: the laws, as `forward_selection` chose them in the design matrix `screen`.
    `law`: joint fit of the baseline and the listed laws, or their parameters about which `smooth`, the smooth term on
    top, was linearized. `theta_covariance`: of `theta`. `clusters`: those that the model was fitted to. `defaults`:
    whether the default parameters agree with the data. `dispersion`: variance of the noise in units of the sensor's.
    `inconclusive`: a law that too few launches support. `misfit`: whether something is missing that no law explains.
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
        """The smooth term on top of them, if any."""
        return self.smooth.family if self.smooth else None

    @property
    def theta(self) -> np.ndarray:
        """Steps (n,) of the law's free parameters, then the smooth term's coefficients (k,); empty without one."""
        return self.smooth.theta if self.smooth else np.zeros(0)

    @property
    def columns(self) -> DesignMatrix:
        """The design matrix about the final law."""
        return self.smooth.columns if self.smooth else self.screen

    @property
    def final(self) -> LeastSquaresFit:
        """The fit of the baseline and the listed laws, beside the smooth term where there is one."""
        if self.unlisted is None:
            return self.law
        values = dict(self.law.values)
        for k, name in enumerate(self.law.free):
            values[name] = BY_NAME[name].within(values[name] + float(self.theta[k]))
        n = len(self.law.free)
        return replace(self.law, values=values, covariance=self.theta_covariance[:n, :n])

    @property
    def coefficients(self) -> np.ndarray:
        """Of the smooth term (k,)."""
        return self.theta[len(self.law.free) :]

    @property
    def all_values(self) -> Mapping[str, float]:
        """All parameters by name, those of the smooth term too where the simulator can represent it."""
        return {**self.final.values, **self.effect_parameters()}

    def gained(self, parts: np.ndarray) -> float:
        """What the smooth term explains of units: how much lower their penalized least squares are with it."""
        assert self.unlisted is not None
        spread = self.model.spreads[self.model.laws.index(self.unlisted)]
        left = []
        for model in (Model(self.law.free), Model(self.law.free, (self.unlisted,), (spread,))):
            columns, ridge = model.columns(self.columns.equations)
            theta = normal_equations.solve(self.columns.equations, columns, parts, ridge)
            left.append(float(normal_equations.losses(self.columns.equations, columns, theta, parts).sum()))
        return left[0] - left[1]

    def losses(self, theta: np.ndarray, parts: np.ndarray) -> np.ndarray:
        """Sums of squares (parts,) that `theta`, see there, leaves of units."""
        assert self.unlisted is not None
        index, _ = Model(self.law.free, (self.unlisted,), (1.0,)).columns(self.columns.equations)
        return normal_equations.losses(self.columns.equations, index, theta, parts)

    def final_losses(self, parts: np.ndarray) -> np.ndarray:
        """Sums of squares (parts,) that the law with its smooth term leaves of units. Coefficients that each launch has
        of its own are fitted to every second unit and tested on those between."""
        assert self.unlisted is not None
        if not self.unlisted.each_launch:
            return self.losses(self.theta, parts)
        equations, n = self.columns.equations, len(self.law.free)
        stepped = normal_equations.moved(equations, equations.columns(self.law.free), self.theta[:n])
        left, odd = np.zeros(len(parts)), np.arange(len(parts)) % 2 == 1
        for tested in (odd, ~odd):
            own = normal_equations.solve(stepped, equations.columns(self.unlisted.columns), parts[~tested])
            left[tested] = self.losses(np.concatenate([self.theta[:n], own]), parts[tested])
        return left

    def effect_parameters(self) -> Mapping[str, float]:
        """The simulator's parameters of the smooth term; empty where it cannot represent it."""
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

    `clear`: whether the regimes that this one rests on are explained, so that a misfit means physics of its own and a
    smooth term may be tried. `dispersion`: variance of the noise in units of the sensor's, where it is known; otherwise
    the richest model estimates it.
    """
    first = given(defaults)
    if problem.first_fitted != problem.base:
        first = fit(problem, defaults, problem.first_fitted, use)
    use, baseline = without_leverage(problem, fit(problem, first.values, problem.base, use), use)
    screen = identifiable(problem.columns(baseline.values, (), use), problem, use)
    laws = [*screen.listed, *screen.families]
    dispersion = dispersion or estimated_dispersion(screen.equations, problem.units, problem.base, laws, use)
    selection = ForwardSelection(screen.equations, problem.units, use, dispersion, _least_gain(problem))
    grown = selection.add_forward(Model(problem.base), screen.listed, ENGINE.most_listed)
    listed, law = eliminated(problem, baseline, selection.eliminate_backward(grown), screen, use)
    best = CandidateModel(listed, law, None, np.inf)
    if clear:
        best = best_candidate(problem, baseline, law, listed, selection, screen, use)
    model, law, smooth = best.model, best.law, best.smooth
    kept = use if smooth else without_outliers(problem, law, use)
    if len(kept) < len(use):
        law = refit(problem, baseline, [one for one in model.laws if not one.family], screen, kept)
    gains = selection.gains(model, screen.listed) if clear else []
    return SearchResult(
        baseline=baseline,
        model=model,
        law=law,
        smooth=smooth,
        theta_covariance=_covariance(problem, smooth, use),
        clusters=kept,
        defaults=defaults_accepted(problem, defaults, baseline, use, dispersion),
        dispersion=dispersion,
        screen=screen,
        forward_selection=selection,
        inconclusive=_inconclusive(selection, gains),
        misfit=clear and not model.laws and has_misfit(problem, baseline, law, use),
    )


def without(problem: Problem, found: SearchResult, law: Law) -> SearchResult:
    """Return the same without one of its laws: the rest of the model, fitted anew to the same clusters."""
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


def bare(found: SearchResult) -> SearchResult:
    """Return the same without laws: the baseline."""
    model = Model(found.model.base)
    none = np.zeros((0, 0))
    return replace(found, model=model, law=found.baseline, smooth=None, theta_covariance=none, inconclusive=None)


def _covariance(problem: Problem, smooth: NonparametricFit | None, use: np.ndarray) -> np.ndarray:
    return smooth.covariance(problem, use) if smooth else np.zeros((0, 0))


def _least_gain(problem: Problem) -> float:
    """How much a law must lower the loss where a calibrated camera's map has errors: by the square of twice their size
    in units of the noise. Where the outline of a puck crosses a line of the table, some places err by half of that."""
    if not problem.place_error_m:
        return 0.0
    return (ENGINE.calibration_errors * problem.place_error_m / problem.noise_m) ** 2


def _inconclusive(selection: ForwardSelection, gains: Sequence[Gain]) -> Law | None:
    """The law that fits best of those that only few launches support."""
    some = [gain for gain in gains if selection.inconclusive(gain)]
    return max(some, key=lambda gain: gain.fitted).law if some else None
