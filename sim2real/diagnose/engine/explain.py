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
from sim2real.diagnose.engine.smooth import Smooth, fit_smooth
from sim2real.diagnose.problem import Columns, Problem

MOST_LISTED = 4
PER_COEFFICIENT = 7.0  # residuals, below which a smooth law would follow the noise
REMAINDER = 0.1  # share of what the listed laws foretell better that a law on top of them must add
MOSTLY = 2.0 / 3.0  # of what a family alone explains; listed laws that explain as much are no stand-ins,
FEW = 2  # unless there are more of them than one table may have
TRIED = 2  # families that foretell best, and as many that fit best, that are fitted by themselves


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
    screen = _tellable(problem.columns(baseline.values, (), use), problem, use)
    laws = [*screen.listed, *screen.families]
    beyond = beyond or dispersion(screen.grams, problem.units, problem.base, laws, use)
    chooser = Chooser(screen.grams, problem.units, use, beyond)
    model, gains = chooser.add(Model(problem.base), screen.listed, MOST_LISTED)
    listed, law = standing(problem, baseline, chooser.prune(model), screen, use)
    way = _completed(problem, baseline, law, listed, chooser, screen, use) if clear else _Way(listed, law, None, np.inf)
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


@dataclass(frozen=True)
class _Way:
    """One way to explain a problem: the `model` as it was chosen, its fit, and the family on top of it. `foretold`:
    the loss of units held out, about the fit itself."""

    model: Model
    law: Fit
    smooth: Smooth | None
    foretold: float

    @property
    def cost(self) -> int:
        """How much is said: a listed law is a name, a family is a name and a shape."""
        return len(self.model.laws) + (self.smooth is not None)


def _completed(
    problem: Problem, baseline: Fit, law: Fit, listed: Model, chooser: Chooser, screen: Columns, use: np.ndarray
) -> _Way:
    """The listed laws, of which `law` is the fit, with a family for what they leave, or in their place."""
    plain = _Way(listed, law, None, np.inf)
    if nearly_all(problem, baseline, law, use):
        return plain
    columns = screen
    if law is not baseline:
        columns = _tellable(problem.columns(law.values, law.free, None), problem, use)
    refitted = Chooser(columns.grams, problem.units, use, chooser.dispersion)
    rest = _remainder(chooser, listed, refitted, law, columns)
    if rest is None and not far_off(problem, baseline, law, use):
        return plain
    ways = [replace(plain, foretold=float(refitted.foretold(Model(law.free)).sum()))]
    nothing = float(chooser.foretold(Model(problem.base)).sum())
    gains = _worth_trying(chooser, Model(problem.base), screen)
    if rest is not None and not listed.laws and rest.law.name not in {gain.law.name for gain in gains}:
        gains.append(rest)
    alone = []
    for gain in gains:
        if nothing - gain.fitted < min(way.foretold for way in (*ways, *alone)):  # what it might leave, if it were true
            alone.append(_with_family(problem, Model(problem.base), baseline, gain, chooser, use))
    if not _stands_by_itself(ways[0], alone, nothing):
        ways += alone
    if rest is not None and listed.laws:
        ways.append(_with_family(problem, listed, law, rest, chooser, use))
        fewer = chooser.prune(listed.plus(rest.law, rest.spread)).minus(rest.law)
        if len(fewer.laws) < len(listed.laws) and fewer.laws:
            fewer, fitted = standing(problem, baseline, fewer, screen, use)
            ways.append(_with_family(problem, fewer, fitted, rest, chooser, use))
    return _simplest(ways, nothing)


def _stands_by_itself(listed: _Way, alone: Sequence[_Way], nothing: float) -> bool:
    """Whether listed laws explain so much of what a family by itself does that they are no stand-ins for it."""
    best = min((way.foretold for way in alone), default=np.inf)
    return 0 < len(listed.model.laws) <= FEW and nothing - listed.foretold > MOSTLY * (nothing - best)


def _with_family(problem: Problem, listed: Model, law: Fit, gain: Gain, chooser: Chooser, use: np.ndarray) -> _Way:
    smooth = fit_smooth(problem, law, gain.law, use, chooser.dispersion)
    return _Way(listed.plus(smooth.family, smooth.spread), smooth.law, smooth, smooth.foretold)


def _worth_trying(chooser: Chooser, base: Model, screen: Columns) -> list[Gain]:
    """The families that may explain most by themselves, best first: those that fit best and those that foretell best,
    as far as that can be seen from the baseline's path."""
    gains = [gain for gain in (chooser.gain(base, law) for law in screen.families) if chooser.fits(gain)]
    foretelling = sorted(gains, key=lambda gain: -gain.total)[:TRIED]
    fitting = sorted(gains, key=lambda gain: 2.0 * len(gain.law.columns) - gain.fitted)[:TRIED]
    return list({gain.law.name: gain for gain in (*fitting, *foretelling)}.values())


def _simplest(ways: Sequence[_Way], nothing: float) -> _Way:
    """The way that says least of those that foretell hardly worse than the best; `nothing`: the baseline's loss."""
    best = min(way.foretold for way in ways)
    enough = max(LEAST_FORETOLD, LEAST_SHARE * (nothing - best))
    return min((way for way in ways if way.foretold < best + enough), key=lambda way: (way.cost, way.foretold))


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


def _explained(chooser: Chooser, model: Model) -> float:
    return float((chooser.foretold(Model(model.base)) - chooser.foretold(model)).sum())
