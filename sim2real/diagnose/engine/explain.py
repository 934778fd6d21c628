"""From a problem to what it lacks: refit the baseline, add what the recording asks for, and see what remains."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.stats import chi2

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import AMBIGUOUS, Chooser, Gain, Law, Model
from sim2real.diagnose.engine.fit import Fit, fit
from sim2real.diagnose.finding import Rival
from sim2real.diagnose.problem import Columns, Problem

MOST_LISTED = 4
FEWEST_CLUSTERS = 4
CLEAR = 1e-4  # chance at which the simulator's own numbers would be refused though they are right
REMAINDER = 0.1  # share of what the listed laws explain that a remainder must exceed to be worth a law
STRAY = 6.0  # times the usual sum of squares: a launch in which something else happened
MOST_STRAY = 0.1


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
        n = len(self.law.free)
        moved = {
            name: float(np.clip(self.law.values[name] + step, BY_NAME[name].low, BY_NAME[name].high))
            for name, step in zip(self.law.free, self.theta[:n], strict=True)
        }
        return replace(self.law, values={**self.law.values, **moved}, covariance=self.theta_covariance[:n, :n])


def explain(problem: Problem, shipped: Mapping[str, float], use: np.ndarray) -> Explained:
    """Explain the clusters `use` of a problem, starting from the simulator's own numbers `shipped`."""
    baseline = fit(problem, shipped, problem.base, use)
    screen = problem.columns(baseline.values)
    base = Model(problem.base)
    chooser = Chooser(screen.grams, use, _dispersion(problem, screen, use))
    model, rounds = chooser.add(base, screen.listed, MOST_LISTED)
    model = chooser.prune(model)
    family = _remainder(chooser, model, screen.families)
    if family is not None:
        model = chooser.prune(model.plus(family.law, family.spread))
    listed = tuple(law for law in model.laws if not law.family)
    unlisted = next((law for law in model.laws if law.family), None)
    law = _refit(problem, baseline, listed, use)
    calm = _calm(problem, law, use, unlisted)
    if len(calm) < len(use):
        law = _refit(problem, baseline, listed, calm)
    theta, spread, columns = _smooth(problem, law, unlisted, model, screen, use)
    also, rivals = {}, {}
    for one in model.laws:
        also[one.name], rivals[one.name] = _compare(chooser, model, one, [*screen.listed, *screen.families])
    return Explained(
        baseline, law, _as_shipped(problem, shipped, baseline, use, chooser.dispersion), chooser.dispersion, listed,
        unlisted, theta, spread, columns, {one.name: _chance(chooser, model, one, screen) for one in model.laws},
        also, rivals, tuple(rounds[0]) if rounds else (),
    )  # fmt: skip


def _dispersion(problem: Problem, screen: Columns, use: np.ndarray) -> float:
    """Noise beyond the sensor's, in variance: what even the richest law leaves. At least 1."""
    every = Model(problem.base)
    for law in (*screen.listed, *screen.families):
        every = every.plus(law, 1.0)
    columns, ridge = every.columns(screen.grams)
    theta = gram.solve(screen.grams, columns, use, ridge + 1e-6)
    left = gram.losses(screen.grams, columns, theta, use)
    freedom = problem.freedom[use]
    typical = np.median(left / np.maximum(freedom, 1.0))
    return float(max(typical, 1.0))


def _remainder(chooser: Chooser, model: Model, families) -> Gain | None:
    """The family that explains most of what the listed laws leave, if that is more than chance and worth a law."""
    gains = sorted((chooser.gain(model, law) for law in families), key=lambda gain: -gain.total)
    explained = float((chooser.foretold(Model(model.base)) - chooser.foretold(model)).sum())
    for gain in gains:
        if chooser.passes(gain) and gain.total > REMAINDER * explained:
            return gain
    return None


def _refit(problem: Problem, baseline: Fit, listed: tuple[Law, ...], use: np.ndarray) -> Fit:
    """The nonlinear fit of the baseline and the listed laws together."""
    if not listed:
        return baseline
    values, free = dict(baseline.values), list(problem.base)
    for law in listed:
        values.update(law.start)
        free += [name for name in problem.rows(law) if name not in free]
    return fit(problem, values, free, use)


def _calm(problem: Problem, law: Fit, use: np.ndarray, unlisted: Law | None) -> np.ndarray:
    """The clusters that the final law explains; a few that it does not saw something of their own, and are left out."""
    found = problem.residuals(law.values, (), use)
    loss = np.bincount(found.cluster, found.r**2, problem.clusters)[use] / np.maximum(problem.freedom[use], 1.0)
    stray = loss > STRAY * max(float(np.median(loss)), 1.0)
    few = 0 < stray.sum() <= MOST_STRAY * len(use) and unlisted is None
    return use[~stray] if few else use


def _smooth(problem: Problem, law: Fit, unlisted: Law | None, model: Model, screen: Columns, use: np.ndarray):
    """Coefficients of the family on top of the final fit, their covariance, and the columns that they belong to."""
    columns = screen if unlisted is None else problem.columns(law.values)
    if unlisted is None:
        return np.zeros(0), np.zeros((0, 0)), columns
    spread = model.spreads[model.laws.index(unlisted)]
    index, ridge = Model(law.free, (unlisted,), (spread,)).columns(columns.grams)
    theta = gram.solve(columns.grams, index, use, ridge)
    return theta, gram.covariance(columns.grams, index, theta, use), columns


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
