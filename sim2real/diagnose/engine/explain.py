"""From a problem to what it lacks: refit the baseline, add what the recording asks for, and see what remains."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import Chooser, Gain, Law, Model
from sim2real.diagnose.engine.fit import Fit, fit, given
from sim2real.diagnose.engine.noise import dispersion
from sim2real.diagnose.engine.settle import as_shipped, calm_clusters, far_off, refit, standing, undisturbed
from sim2real.diagnose.engine.ways import Way, completed, tellable
from sim2real.diagnose.problem import Columns, Problem

MOST_LISTED = 4


@dataclass(frozen=True)
class Explained:
    """What the engine found. `law`: the fit of the baseline and the listed laws `listed`, or their numbers beside
    `unlisted`, a family on top; `theta` are further steps of these numbers, and its coefficients. `doubtful`: what too
    few launches ask for beside it; `lost`: whether something is missing that no law surely explains. `columns` are
    those of the final law; `model` was chosen by `chooser` in those of `screen`."""

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

    @property
    def coefficients(self) -> np.ndarray:
        """Of the family (k,)."""
        return self.theta[len(self.law.free) :]

    @property
    def mended(self) -> Mapping[str, float]:
        """The values of all of it, the smooth law and all where the simulator has a place for it."""
        return {**self.final.values, **self.switched()}

    def gained(self, parts: np.ndarray) -> float:
        """What the smooth law can explain of units: how their sum of squares grows without it."""
        assert self.unlisted is not None
        spread = self.model.spreads[self.model.laws.index(self.unlisted)]
        left = []
        for model in (Model(self.law.free), Model(self.law.free, (self.unlisted,), (spread,))):
            columns, ridge = model.columns(self.columns.grams)
            theta = gram.solve(self.columns.grams, columns, parts, ridge)
            left.append(float(gram.losses(self.columns.grams, columns, theta, parts).sum()))
        return left[0] - left[1]

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
        return law.switch(self.coefficients)


def explain(
    problem: Problem, shipped: Mapping[str, float], use: np.ndarray, clear: bool = True, beyond: float | None = None
) -> Explained:
    """Explain the clusters `use` of a problem, starting from the simulator's own numbers `shipped`.

    clear: what fits no listed law is missing physics of this regime, and not what another one left unexplained.
    beyond: noise beyond the problem's, in variance, where it is known; otherwise it is read off the richest law.
    """
    roughly = given(shipped) if problem.plain == problem.base else fit(problem, shipped, problem.plain, use)
    use, baseline = undisturbed(problem, fit(problem, roughly.values, problem.base, use), use)
    screen = tellable(problem.columns(baseline.values, (), use), problem, use)
    laws = [*screen.listed, *screen.families]
    beyond = beyond or dispersion(screen.grams, problem.units, problem.base, laws, use)
    chooser = Chooser(screen.grams, problem.units, use, beyond)
    model, gains = chooser.add(Model(problem.base), screen.listed, MOST_LISTED)
    listed, law = standing(problem, baseline, chooser.prune(model), screen, use)
    way = completed(problem, baseline, law, listed, chooser, screen, use) if clear else Way(listed, law, None, np.inf)
    model, law, smooth = way.model, way.law, way.smooth
    kept = tuple(one for one in model.laws if not one.family)
    calm = use if smooth else calm_clusters(problem, law, use)
    if len(calm) < len(use):
        law = refit(problem, baseline, kept, screen, calm)
    return Explained(
        baseline, law, as_shipped(problem, shipped, baseline, use, beyond), beyond, kept,
        smooth.family if smooth else None, smooth.theta if smooth else np.zeros(0),
        smooth.covariance(problem, use) if smooth else np.zeros((0, 0)), smooth.columns if smooth else screen,
        screen, chooser, model,
        _doubtful(chooser, _beside(chooser, model, screen) if model.laws else gains) if clear else None,
        clear and not model.laws and far_off(problem, baseline, law, use),
    )  # fmt: skip


def _beside(chooser: Chooser, model: Model, screen: Columns) -> list[Gain]:
    """What each listed law would add to a model that has others."""
    taken = {law.name for law in model.laws}
    return [chooser.gain(model, law) for law in screen.listed if law.name not in taken]


def _doubtful(chooser: Chooser, gains: Sequence[Gain]) -> Law | None:
    """The law that fits best of those that few launches alone ask for."""
    some = [gain for gain in gains if chooser.doubtful(gain)]
    return max(some, key=lambda gain: gain.fitted).law if some else None
