"""From a problem to what it lacks: refit the baseline, add what the recording asks for, and see what remains."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import Chooser, Gain, Model
from sim2real.diagnose.engine.fit import Fit, fit, given
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.noise import dispersion
from sim2real.diagnose.engine.settle import as_shipped, calm_clusters, far_off, refit, standing, undisturbed
from sim2real.diagnose.engine.smooth import Smooth, fit_smooth
from sim2real.diagnose.engine.ways import Way, completed, tellable
from sim2real.diagnose.problem import Columns, Problem

MOST_LISTED = 4
CLEAR_OF = 2.0


@dataclass(frozen=True, kw_only=True)
class Explained:
    """What the engine found. `law`: the fit of the baseline and the listed laws, or their numbers beneath `smooth`, a
    family on top. `doubtful`: what too few launches ask for beside it; `lost`: whether something is missing that no law
    surely explains. `model` was chosen by `chooser` in the columns of `screen`; `clusters` are those that it was fitted
    to; `theta_covariance`: of the smooth law's `theta`."""

    baseline: Fit
    model: Model
    law: Fit
    smooth: Smooth | None
    theta_covariance: np.ndarray
    clusters: np.ndarray
    shipped: bool
    dispersion: float
    screen: Columns
    chooser: Chooser
    doubtful: Law | None
    lost: bool

    @property
    def listed(self) -> tuple[Law, ...]:
        """The laws of the model that have a name."""
        return tuple(one for one in self.model.laws if not one.family)

    @property
    def unlisted(self) -> Law | None:
        """The family on top of them."""
        return self.smooth.family if self.smooth else None

    @property
    def theta(self) -> np.ndarray:
        """Further steps of the law's numbers, and the family's coefficients; none without a family."""
        return self.smooth.theta if self.smooth else np.zeros(0)

    @property
    def columns(self) -> Columns:
        """The columns of the final law."""
        return self.smooth.columns if self.smooth else self.screen

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

    def left(self, parts: np.ndarray) -> np.ndarray:
        """Sums of squares (parts,) that the law with its family leaves of units. Numbers that each launch has of its
        own, which no other one foretells, are told by every second unit, and tried on those between."""
        assert self.unlisted is not None
        if not self.unlisted.each_launch:
            return self.losses(self.theta, parts)
        grams, n = self.columns.grams, len(self.law.free)
        stepped = gram.moved(grams, grams.columns(self.law.free), self.theta[:n])
        left, odd = np.zeros(len(parts)), np.arange(len(parts)) % 2 == 1
        for tried in (odd, ~odd):
            own = gram.solve(stepped, grams.columns(self.unlisted.columns), parts[~tried])
            left[tried] = self.losses(np.concatenate([self.theta[:n], own]), parts[tried])
        return left

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
    chooser = Chooser(screen.grams, problem.units, use, beyond, _least(problem))
    model = chooser.prune(chooser.add(Model(problem.base), screen.listed, MOST_LISTED))
    listed, law = standing(problem, baseline, model, screen, use)
    way = completed(problem, baseline, law, listed, chooser, screen, use) if clear else Way(listed, law, None, np.inf)
    model, law, smooth = way.model, way.law, way.smooth
    calm = use if smooth else calm_clusters(problem, law, use)
    if len(calm) < len(use):
        law = refit(problem, baseline, [one for one in model.laws if not one.family], screen, calm)
    hints = chooser.gains(model, screen.listed) if clear else []
    return Explained(
        baseline=baseline,
        model=model,
        law=law,
        smooth=smooth,
        theta_covariance=_covariance(problem, smooth, use),
        clusters=calm,
        shipped=as_shipped(problem, shipped, baseline, use, beyond),
        dispersion=beyond,
        screen=screen,
        chooser=chooser,
        doubtful=_doubtful(chooser, hints),
        lost=clear and not model.laws and far_off(problem, baseline, law, use),
    )


def without(problem: Problem, found: Explained, law: Law) -> Explained:
    """The same with one of its laws less: what is left of the model, fitted anew to the same clusters."""
    model = found.model.minus(law)
    named = [one for one in model.laws if not one.family]
    fitted, smooth = found.baseline, None
    if named:
        gone = () if law.family else law.rows
        values = {**found.law.values, **{name: BY_NAME[name].default for name in gone}}
        fitted = fit(problem, values, [name for name in found.law.free if name not in gone], found.clusters)
    if found.unlisted is not None and not law.family:
        smooth = fit_smooth(problem, fitted, found.unlisted, found.clusters, found.dispersion)
        fitted, model = smooth.law, model.minus(found.unlisted).plus(smooth.family, smooth.spread)
    spread = _covariance(problem, smooth, found.clusters)
    return replace(found, model=model, law=fitted, smooth=smooth, theta_covariance=spread)


def bare(found: Explained) -> Explained:
    """The same with no law but the baseline."""
    model = Model(found.model.base)
    none = np.zeros((0, 0))
    return replace(found, model=model, law=found.baseline, smooth=None, theta_covariance=none, doubtful=None)


def _covariance(problem: Problem, smooth: Smooth | None, use: np.ndarray) -> np.ndarray:
    return smooth.covariance(problem, use) if smooth else np.zeros((0, 0))


def _least(problem: Problem) -> float:
    """What a law must explain, in units of the noise: places that a calibrated camera saw it must move, in the root of
    the sum of squares, by more than CLEAR_OF times what the calibration has each of them wrong by. Where the outline of
    a puck crosses a line of the table, some are off by half of that."""
    return (CLEAR_OF * problem.place_error_m / problem.noise_m) ** 2 if problem.place_error_m else 0.0


def _doubtful(chooser: Chooser, gains: Sequence[Gain]) -> Law | None:
    """The law that fits best of those that few launches alone ask for."""
    some = [gain for gain in gains if chooser.doubtful(gain)]
    return max(some, key=lambda gain: gain.fitted).law if some else None
