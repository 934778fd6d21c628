"""From a problem to what it lacks: refit the baseline, add what the recording asks for, and see what remains."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import LEAST_FORETOLD, LEAST_SHARE, Chooser, Gain, Law, Model
from sim2real.diagnose.engine.fit import Fit, fit, given
from sim2real.diagnose.engine.noise import dispersion
from sim2real.diagnose.engine.settle import as_shipped, calm_clusters, far_off, nearly_all, refit, standing, undisturbed
from sim2real.diagnose.problem import Columns, Problem

MOST_LISTED = 4
PER_COEFFICIENT = 7.0  # residuals, below which a smooth law would follow the noise
REMAINDER = 0.1  # share of what the listed laws foretell better that a law on top of them must add
HALF = 0.5  # of what listed laws explain that leave much; a family that explains as much is nearer to the truth
FEW = 2  # listed laws that one table may have; more of them, needless beside a family, only stood in for it
MOSTLY = 2.0 / 3.0  # of what a family alone explains; listed laws that explain as much are no stand-ins


@dataclass(frozen=True)
class Explained:
    """What the engine found. `law`: the final fit, of the baseline and the listed laws `listed`; `unlisted` and its
    coefficients `theta` are a family on top of it. `doubtful`: what too few launches ask for beside it; `lost`: whether
    something is missing that no law surely explains. `columns` are those of the final law; `model` was chosen by
    `chooser` in those of `screen`."""

    baseline: Fit
    law: Fit
    shipped: bool
    dispersion: float
    listed: tuple[Law, ...]
    unlisted: Law | None
    theta: np.ndarray
    theta_covariance: np.ndarray
    columns: Columns
    screen: Columns
    chooser: Chooser
    model: Model
    doubtful: Law | None
    lost: bool

    @property
    def final(self) -> Fit:
        """The fit of the baseline and the listed laws beside the smooth one, where there is one."""
        if self.unlisted is None:
            return self.law
        values = dict(self.law.values)
        for k, name in enumerate(self.law.free):
            values[name] = BY_NAME[name].within(values[name] + float(self.theta[k]))
        n = len(self.law.free)
        return replace(self.law, values=values, covariance=self.theta_covariance[:n, :n])

    def losses(self, theta: np.ndarray, parts: np.ndarray) -> np.ndarray:
        """Sums of squares (parts,) that coefficients of the family, and steps of the listed numbers, leave of units."""
        assert self.unlisted is not None
        index, _ = Model(self.law.free, (self.unlisted,), (1.0,)).columns(self.columns.grams)
        return gram.losses(self.columns.grams, index, theta, parts)

    def switched(self) -> Mapping[str, float]:
        """The simulator's parameters that switch the smooth law on; empty where it has no place for it."""
        if self.unlisted is None:
            return {}
        law = next(one for one in self.columns.families if one.name == self.unlisted.name)
        return law.switch(self.theta[len(self.law.free) :])


def explain(
    problem: Problem, shipped: Mapping[str, float], use: np.ndarray, clear: bool = True, beyond: float | None = None
) -> Explained:
    """Explain the clusters `use` of a problem, starting from the simulator's own numbers `shipped`.

    clear: what fits no listed law is missing physics of this regime, and not what another one left unexplained.
    beyond: noise beyond the problem's, in variance, where it is known; otherwise it is read off the richest law.
    """
    roughly = given(shipped) if problem.plain == problem.base else fit(problem, shipped, problem.plain, use)
    use, baseline = undisturbed(problem, fit(problem, roughly.values, problem.base, use), use)
    screen = _tellable(problem.columns(baseline.values, (), use), problem, use)
    laws = [*screen.listed, *screen.families]
    beyond = beyond or dispersion(screen.grams, problem.units, problem.base, laws, use)
    chooser = Chooser(screen.grams, problem.units, use, beyond)
    model, gains = chooser.add(Model(problem.base), screen.listed, MOST_LISTED)
    listed, law = standing(problem, baseline, chooser.prune(model), screen, use)
    model = _completed(problem, baseline, law, listed, chooser, screen, use) if clear else listed
    if model is not listed:
        model, law = standing(problem, baseline, model, screen, use)
    unlisted = next((one for one in model.laws if one.family), None)
    kept = tuple(one for one in model.laws if not one.family)
    calm = use if unlisted else calm_clusters(problem, law, use)
    if len(calm) < len(use):
        law = refit(problem, baseline, kept, screen, calm)
    theta, spread, columns = _smooth(problem, law, unlisted, model, screen, use)
    return Explained(
        baseline, law, as_shipped(problem, shipped, baseline, use, beyond), beyond, kept,
        unlisted, theta, spread, columns, screen, chooser, model,
        _doubtful(chooser, _beside(chooser, model, screen) if model.laws else gains) if clear else None,
        clear and not model.laws and far_off(problem, baseline, law, use),
    )  # fmt: skip


def _completed(
    problem: Problem, baseline: Fit, law: Fit, listed: Model, chooser: Chooser, screen: Columns, use: np.ndarray
) -> Model:
    """The listed laws, of which `law` is the fit, with a family for what they leave, or in their place."""
    model = listed
    if not nearly_all(problem, baseline, law, use):
        columns = screen
        if law is not baseline:
            columns = _tellable(problem.columns(law.values, law.free, None), problem, use)
        refitted = Chooser(columns.grams, problem.units, use, chooser.dispersion)
        model = _with_remainder(chooser, listed, _remainder(chooser, listed, refitted, law, columns), screen)
    if any(one.family for one in model.laws) or not far_off(problem, baseline, law, use):
        return model
    smooth = _likeliest(chooser, Model(problem.base), screen)
    return smooth if smooth is not None and _explained(chooser, smooth) > HALF * _explained(chooser, model) else model


def _beside(chooser: Chooser, model: Model, screen: Columns) -> list[Gain]:
    """What each listed law would add to a model that has others."""
    taken = {law.name for law in model.laws}
    return [chooser.gain(model, law) for law in screen.listed if law.name not in taken]


def _doubtful(chooser: Chooser, gains: Sequence[Gain]) -> Law | None:
    """The law that fits best of those that few launches alone ask for."""
    some = [gain for gain in gains if chooser.doubtful(gain)]
    return max(some, key=lambda gain: gain.fitted).law if some else None


def _tellable(columns: Columns, problem: Problem, use: np.ndarray) -> Columns:
    """The columns, with no families but those of which the clusters `use` can tell the shape."""
    most = float(problem.freedom[use].sum()) / PER_COEFFICIENT
    return replace(columns, families=[law for law in columns.families if len(law.columns) <= most])


def _remainder(chooser: Chooser, model: Model, refitted: Chooser, law: Fit, columns: Columns) -> Gain | None:
    """The family that explains most of what the listed laws leave once they are refitted (`law`, with its `columns`),
    if that is more than chance and worth a law."""
    gains = sorted((refitted.gain(Model(law.free), one) for one in columns.families), key=lambda gain: -gain.total)
    explained = _explained(chooser, model)
    for gain in gains:
        if refitted.passes(gain) and gain.total > REMAINDER * explained:
            return gain
    return None


def _with_remainder(chooser: Chooser, model: Model, rest: Gain | None, screen: Columns) -> Model:
    """The model with the family `rest` on top; or a family alone, where that does as well and the listed laws are but a
    part of it: then they only stood in for it."""
    if rest is None:
        return model
    both = chooser.prune(model.plus(rest.law, rest.spread))
    alone = _likeliest(chooser, Model(model.base), screen)
    if alone is None:
        return both
    stood_in = len(model.laws) > FEW and all(one.family for one in both.laws)
    if model.laws and not stood_in and _explained(chooser, model) > MOSTLY * _explained(chooser, alone):
        return model.plus(rest.law, rest.spread)
    worse = _explained(chooser, both) - _explained(chooser, alone)
    return alone if worse < max(LEAST_FORETOLD, LEAST_SHARE * _explained(chooser, both)) else both


def _likeliest(chooser: Chooser, base: Model, screen: Columns) -> Model | None:
    """The baseline and the family that alone foretells best, of those that are more than chance; few launches may do:
    that something is missing is sure already."""
    some = [gain for gain in (chooser.gain(base, law) for law in screen.families) if chooser.likely(gain)]
    best = max(some, key=lambda gain: gain.total, default=None)
    return None if best is None else base.plus(best.law, best.spread)


def _explained(chooser: Chooser, model: Model) -> float:
    return float((chooser.foretold(Model(model.base)) - chooser.foretold(model)).sum())


def _smooth(problem: Problem, law: Fit, unlisted: Law | None, model: Model, screen: Columns, use: np.ndarray):
    """Coefficients of the family on top of the final fit, their covariance, and the columns that they belong to."""
    if unlisted is None:
        return np.zeros(0), np.zeros((0, 0)), screen
    columns = problem.columns(law.values, law.free, None)
    spread = model.spreads[model.laws.index(unlisted)]
    index, ridge = Model(law.free, (unlisted,), (spread,)).columns(columns.grams)
    units = problem.units.of(use)
    theta = gram.solve_softly(columns.grams, index, units, problem.units.freedom[units], ridge)
    launches = gram.gathered(columns.grams, problem.units.cluster, problem.clusters)
    return theta, gram.covariance(launches, index, theta, use), columns
