"""From a problem to what it lacks: refit the baseline, add what the recording asks for, and see what remains."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.stats import chi2

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import AMBIGUOUS, LEAST_FORETOLD, LEAST_SHARE, Chooser, Gain, Law, Model
from sim2real.diagnose.engine.fit import Fit, fit
from sim2real.diagnose.finding import Rival
from sim2real.diagnose.problem import Columns, Problem

MOST_LISTED = 4
FEWEST_CLUSTERS = 4
CLEAR = 1e-4  # chance at which the simulator's own numbers would be refused though they are right
REMAINDER = 0.1  # share of what the listed laws explain that a remainder must exceed to be worth a law
FAR_OFF = 2.0  # mean square residual beyond 1 of a typical launch, in units of the noise, that nothing explains
NEAR, HALF_WAY = 0.3, 0.3  # the same beside listed laws, and as a share of what the baseline leaves
STRAY = 6.0  # times the usual sum of squares: a launch in which something else happened
MOST_STRAY = 0.1
LEAST_SIZE = 20.0  # sum of squares by which a law must stand out of the final fit
FEW_ROUNDS = 4  # of a fit, to see which start leads farthest


@dataclass(frozen=True)
class Explained:
    """What the engine found. `law`: the final fit, of the baseline and the listed laws `listed`; `unlisted` and its
    coefficients `theta` are a family on top of it. `also` and `rivals` are by the name of the law."""

    baseline: Fit
    law: Fit
    shipped: bool
    dispersion: float
    listed: tuple[Law, ...]
    unlisted: Law | None
    theta: np.ndarray
    theta_covariance: np.ndarray
    columns: Columns
    chance: Mapping[str, float]
    also: Mapping[str, tuple[str, ...]]
    rivals: Mapping[str, tuple[Rival, ...]]
    gains: tuple[Gain, ...] = field(default=())

    @property
    def final(self) -> Fit:
        """The fit of the baseline and the listed laws beside the smooth one, where there is one."""
        if self.unlisted is None:
            return self.law
        values = dict(self.law.values)
        for k, name in enumerate(self.law.free):
            row = BY_NAME[name]
            values[name] = float(np.clip(values[name] + self.theta[k], row.low, row.high))
        n = len(self.law.free)
        return replace(self.law, values=values, covariance=self.theta_covariance[:n, :n])

    def switched(self) -> Mapping[str, float]:
        """The simulator's parameters that switch the smooth law on; empty where it has no place for it."""
        if self.unlisted is None:
            return {}
        law = next(one for one in self.columns.families if one.name == self.unlisted.name)
        return law.switch(self.theta[len(self.law.free) :])


def explain(problem: Problem, shipped: Mapping[str, float], use: np.ndarray, clear: bool = True) -> Explained:
    """Explain the clusters `use` of a problem, starting from the simulator's own numbers `shipped`.

    clear: what is far off and fits no law is missing physics of this regime, and not what another one left unexplained.
    """
    baseline = fit(problem, shipped, problem.base, use)
    screen = problem.columns(baseline.values)
    chooser = Chooser(screen.grams, problem.units, use, _dispersion(problem, screen, use))
    model, gains = chooser.add(Model(problem.base), screen.listed, MOST_LISTED)
    model, law = _standing(problem, baseline, chooser.prune(model), screen, use)
    columns = screen if law is baseline else problem.columns(law.values, law.free)
    refitted = Chooser(columns.grams, problem.units, use, chooser.dispersion)
    model = _with_remainder(chooser, model, _remainder(chooser, model, refitted, law, columns), screen)
    if clear and not any(one.family for one in model.laws) and far_off(problem, baseline, law, use):
        model = _likeliest(chooser, Model(problem.base), screen)
    unlisted = next((law for law in model.laws if law.family), None)
    model, law = _standing(problem, baseline, model, screen, use)
    listed = tuple(law for law in model.laws if not law.family)
    calm = _calm(problem, law, use, unlisted)
    if len(calm) < len(use):
        law = _refit(problem, baseline, listed, screen, calm)
    theta, spread, columns = _smooth(problem, law, unlisted, model, columns, use)
    also, rivals = {}, {}
    for one in model.laws:
        also[one.name], rivals[one.name] = _compare(chooser, model, one, [*screen.listed, *screen.families])
    return Explained(
        baseline, law, _as_shipped(problem, shipped, baseline, use, chooser.dispersion), chooser.dispersion, listed,
        unlisted, theta, spread, columns, {one.name: _chance(chooser, model, one, screen) for one in model.laws},
        also, rivals, tuple(gains),
    )  # fmt: skip


def _dispersion(problem: Problem, screen: Columns, use: np.ndarray) -> float:
    """Noise beyond the sensor's, in variance: what even the richest law leaves of a typical launch. At least 1."""
    every = Model(problem.base)
    for law in (*screen.listed, *screen.families):
        every = every.plus(law, 1.0)
    columns, ridge = every.columns(screen.grams)
    units = problem.units.of(use)
    theta = gram.solve(screen.grams, columns, units, ridge + 1e-6)
    left = np.bincount(problem.units.cluster[units], gram.losses(screen.grams, columns, theta, units), problem.clusters)
    return float(max(np.median(left[use] / np.maximum(problem.freedom[use], 1.0)), 1.0))


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
    """The model with the family `rest` on top; or a family alone, where that does as well: then listed laws only stood
    in for parts of it."""
    if rest is None:
        return model
    both = chooser.prune(model.plus(rest.law, rest.spread))
    alone = _likeliest(chooser, Model(model.base), screen)
    worse = _explained(chooser, both) - _explained(chooser, alone)
    return alone if worse < max(LEAST_FORETOLD, LEAST_SHARE * _explained(chooser, both)) else both


def _likeliest(chooser: Chooser, base: Model, screen: Columns) -> Model:
    """The baseline and the family that alone foretells best."""
    best = max((chooser.gain(base, law) for law in screen.families), key=lambda gain: gain.total)
    return base.plus(best.law, best.spread)


def _explained(chooser: Chooser, model: Model) -> float:
    return float((chooser.foretold(Model(model.base)) - chooser.foretold(model)).sum())


def far_off(problem: Problem, baseline: Fit, law: Fit, use: np.ndarray) -> bool:
    """Whether a law leaves far more than noise of most launches, or much of what the baseline does: then something
    else must be missing."""
    before, after = (float(np.median(_left(problem, one, use))) - 1.0 for one in (baseline, law))
    return after > FAR_OFF or (law is not baseline and after > NEAR and after > HALF_WAY * before)


def _left(problem: Problem, law: Fit, use: np.ndarray) -> np.ndarray:
    """What a law leaves of each cluster in `use`: its mean square residual in units of the noise."""
    found = problem.residuals(law.values, (), use)
    return np.bincount(found.cluster, found.r**2, problem.clusters)[use] / np.maximum(problem.freedom[use], 1.0)


def _refit(problem: Problem, baseline: Fit, listed: Sequence[Law], screen: Columns, use: np.ndarray) -> Fit:
    """The nonlinear fit of the baseline and the listed laws together, from each place at which one was looked for."""
    best = baseline
    for law in listed:
        free = tuple(dict.fromkeys((*best.free, *problem.rows(law))))
        values = {**best.values, **law.start}
        if law.start:
            starts = [one.start for one in screen.listed if one.name == law.name]
            tries = [fit(problem, {**values, **start}, free, use, FEW_ROUNDS) for start in starts]
            values = min(tries, key=lambda one: one.loss).values
        best = fit(problem, values, free, use)
    return best


def _standing(problem: Problem, baseline: Fit, model: Model, screen: Columns, use: np.ndarray) -> tuple[Model, Fit]:
    """The model without listed laws that come to nothing when all are fitted together, and that fit."""
    while True:
        listed = [law for law in model.laws if not law.family]
        fitted = _refit(problem, baseline, listed, screen, use)
        sizes = [_size(problem, fitted, law, use) for law in listed]
        if not sizes or min(sizes) > LEAST_SIZE:
            return model, fitted
        model = model.minus(listed[int(np.argmin(sizes))])


def _size(problem: Problem, fitted: Fit, law: Law, use: np.ndarray) -> float:
    """How surely a law is there: the squares of its numbers by their covariance, or, where the recording does not feel
    them, what the sum of squares grows by without them."""
    rows = [name for name in problem.rows(law) if name in fitted.free]
    off = {name: BY_NAME[name].default for name in rows}
    without = problem.residuals({**fitted.values, **off}, (), use).r
    at = [fitted.free.index(name) for name in rows]
    away = np.array([fitted.values[name] - off[name] for name in rows])
    surely = float(away @ np.linalg.pinv(fitted.covariance[np.ix_(at, at)], hermitian=True) @ away)
    return min(surely, float(without @ without) - fitted.loss)


def _calm(problem: Problem, law: Fit, use: np.ndarray, unlisted: Law | None) -> np.ndarray:
    """The clusters that the final law explains; a few that it does not saw something of their own, and are left out."""
    loss = _left(problem, law, use)
    stray = loss > STRAY * max(float(np.median(loss)), 1.0)
    few = 0 < stray.sum() <= MOST_STRAY * len(use) and unlisted is None
    return use[~stray] if few else use


def _smooth(problem: Problem, law: Fit, unlisted: Law | None, model: Model, columns: Columns, use: np.ndarray):
    """Coefficients of the family on top of the final fit, their covariance, and the columns that they belong to."""
    if unlisted is None:
        return np.zeros(0), np.zeros((0, 0)), columns
    columns = problem.columns(law.values, law.free)
    spread = model.spreads[model.laws.index(unlisted)]
    index, ridge = Model(law.free, (unlisted,), (spread,)).columns(columns.grams)
    units = problem.units.of(use)
    theta = gram.solve_softly(columns.grams, index, units, problem.units.freedom[units], ridge)
    return theta, gram.covariance(columns.grams, index, theta, units), columns


def _as_shipped(problem: Problem, shipped: Mapping[str, float], baseline: Fit, use, dispersion: float) -> bool:
    """Whether the simulator's own numbers explain the recording as well as the refitted ones."""
    found = problem.residuals(shipped, (), use)
    worse = (float(found.r @ found.r) - baseline.loss) / dispersion
    return bool(chi2.sf(max(worse, 0.0), len(problem.base)) > CLEAR)


def _chance(chooser: Chooser, model: Model, law: Law, screen: Columns) -> float:
    """Chance that noise alone gains as much, for as many laws as were tried."""
    gained = chooser.fitted(model.minus(law)) - chooser.fitted(model)
    tried = len(screen.listed) + len(screen.families)
    return float(min(max(tried * chi2.sf(gained, len(law.columns)), 1e-300), 1.0))


def _compare(chooser: Chooser, model: Model, law: Law, others) -> tuple[tuple[str, ...], tuple[Rival, ...]]:
    """What could stand in the place of `law`: names that the data cannot tell from it, and the rivals that lost."""
    without = model.minus(law)
    best = chooser.foretold(model)
    also, rivals = [], {}
    for other in others:
        if other.name == law.name or other.name in {one.name for one in model.laws}:
            continue
        gain = chooser.gain(without, other)
        loss = float((chooser.foretold(without) - gain.foretold - best).sum())
        if loss < AMBIGUOUS and not other.family and not law.family and chooser.passes(gain):
            also.append(other.name)
        if other.name not in rivals or loss < rivals[other.name].loss:
            rivals[other.name] = Rival(
                other.name, loss, _why(gain, loss, float(chooser.foretold(without).sum() - best.sum()))
            )
    ordered = sorted(rivals.values(), key=lambda rival: rival.loss)
    return tuple(dict.fromkeys(also)), tuple(ordered)


def _why(gain: Gain, loss: float, whole: float) -> str:
    if gain.total <= 0.0:
        return "foretells held-out launches no better than the baseline"
    if loss < AMBIGUOUS:
        return "as good: this recording cannot tell the two apart"
    return f"explains {100 * max(1.0 - loss / whole, 0.0):.0f} % of what the winner does"
