"""Ways to explain a problem: listed laws, a smooth law in their place, or both; the simplest that foretells well."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim2real.diagnose.engine.choose import LEAST_FORETOLD, LEAST_SHARE, SPREADS, Chooser, Gain, Model
from sim2real.diagnose.engine.fit import Fit
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.settle import far_off, nearly_all, refit, standing
from sim2real.diagnose.engine.smooth import Smooth, fit_smooth
from sim2real.diagnose.problem import Columns, Problem

PER_COEFFICIENT = 7.0  # residuals, below which a smooth law would follow the noise
REMAINDER = 0.1  # share of what the listed laws foretell better that a law on top of them must add
BEYOND = 0.25  # of what the listed laws leave beyond noise, that it must explain as well
MOSTLY = 2.0 / 3.0  # of what a family alone explains; listed laws that explain as much are no stand-ins,
FEW = 2  # unless there are more of them than one table may have
TOGETHER = 3  # laws, a family and others that are looked for beside it
TRIED = 2  # families that foretell best, and as many that fit best, that are fitted by themselves


@dataclass(frozen=True)
class Way:
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


def completed(
    problem: Problem, baseline: Fit, law: Fit, listed: Model, chooser: Chooser, screen: Columns, use: np.ndarray
) -> Way:
    """The listed laws, of which `law` is the fit, with a family for what they leave, or in their place."""
    plain = Way(listed, law, None, np.inf)
    if nearly_all(problem, baseline, law, use):
        return plain
    columns = screen
    if law is not baseline:
        columns = tellable(problem.columns(law.values, law.free, None), problem, use, law.free)
    refitted = Chooser(columns.grams, problem.units, use, chooser.dispersion, chooser.least)
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
    if not stands_by_itself(ways[0], alone, nothing):
        ways += alone
        ways += _with_more(problem, baseline, gains, alone, chooser, screen, use)
    if rest is not None and listed.laws:
        ways.append(_with_family(problem, listed, law, rest, chooser, use))
        fewer = chooser.prune(listed.plus(rest.law, rest.spread)).minus(rest.law)
        if len(fewer.laws) < len(listed.laws) and fewer.laws:
            fewer, fitted = standing(problem, baseline, fewer, screen, use)
            ways.append(_with_family(problem, fewer, fitted, rest, chooser, use))
    return simplest(ways, nothing)


def _with_more(
    problem: Problem, baseline: Fit, gains: Sequence[Gain], alone: Sequence[Way], chooser: Chooser, screen: Columns, use
) -> list[Way]:
    """The family that explains most by itself with listed laws that show only beside it, where it leaves much."""
    best = min(alone, key=lambda way: way.foretold, default=None)
    nothing = float(chooser.foretold(Model(problem.base)).sum())
    if best is None or best.smooth is None or best.foretold - chooser.noise < REMAINDER * (nothing - best.foretold):
        return []
    gain = next(gain for gain in gains if gain.law.name == best.smooth.family.name)
    grown = chooser.prune(chooser.grown(Model(problem.base).plus(gain.law, gain.spread), screen.listed, TOGETHER))
    if gain.law not in grown.laws or len(grown.laws) == 1:
        return []
    listed = grown.minus(gain.law)  # which may come to nothing without the family, so that none is dropped here
    fitted = refit(problem, baseline, listed.laws, screen, use)
    return [_with_family(problem, listed, fitted, gain, chooser, use)]


def stands_by_itself(listed: Way, alone: Sequence[Way], nothing: float) -> bool:
    """Whether listed laws explain so much of what a family by itself does that they are no stand-ins for it."""
    best = min((way.foretold for way in alone), default=np.inf)
    return 0 < len(listed.model.laws) <= FEW and nothing - listed.foretold > MOSTLY * (nothing - best)


def _with_family(problem: Problem, listed: Model, law: Fit, gain: Gain, chooser: Chooser, use: np.ndarray) -> Way:
    smooth = fit_smooth(problem, law, gain.law, use, chooser.dispersion)
    return Way(listed.plus(smooth.family, smooth.spread), smooth.law, smooth, smooth.foretold)


def _worth_trying(chooser: Chooser, base: Model, screen: Columns) -> list[Gain]:
    """The families that may explain most by themselves, best first: those that fit best and those that foretell best,
    as far as that can be seen from the baseline's path."""
    gains = [gain for gain in (chooser.gain(base, law) for law in screen.families) if chooser.fits(gain)]
    foretelling = sorted(gains, key=lambda gain: -gain.total)[:TRIED]
    fitting = sorted(gains, key=lambda gain: 2.0 * len(gain.law.columns) - gain.fitted)[:TRIED]
    return list({gain.law.name: gain for gain in (*fitting, *foretelling)}.values())


def simplest(ways: Sequence[Way], nothing: float) -> Way:
    """The way that says least of those that foretell hardly worse than the best; `nothing`: the baseline's loss."""
    best = min(way.foretold for way in ways)
    enough = max(LEAST_FORETOLD, LEAST_SHARE * (nothing - best))
    return min((way for way in ways if way.foretold < best + enough), key=lambda way: (way.cost, way.foretold))


def _remainder(chooser: Chooser, model: Model, refitted: Chooser, law: Fit, columns: Columns) -> Gain | None:
    """The family that explains most of what the listed laws leave once they are refitted (`law`, with its `columns`),
    if that is more than chance and worth a law."""
    gains = sorted((refitted.gain(Model(law.free), one) for one in columns.families), key=lambda gain: -gain.total)
    explained = float((chooser.foretold(Model(model.base)) - chooser.foretold(model)).sum())
    left = refitted.fitted(Model(law.free)) - refitted.noise if model.laws else 0.0
    worth = max(REMAINDER * explained, BEYOND * left)
    return next((gain for gain in gains if refitted.passes(gain) and gain.total > worth), None)


def tellable(columns: Columns, problem: Problem, use: np.ndarray, base: Sequence[str] = ()) -> Columns:
    """The columns, with no families but those of which the clusters `use` can tell the shape; of those that are alike
    but for a size, the one that fits best beside the parameters `base`, the problem's if none are given."""
    most = float(problem.freedom[use].sum()) / PER_COEFFICIENT
    chooser = Chooser(columns.grams, problem.units, use)
    found: dict[str, Law] = {}
    left: dict[str, float] = {}
    for law in columns.families:
        key = law.among or law.name
        loss = chooser.fitted(Model(tuple(base) or problem.base, (law,), (SPREADS[-1],))) if law.among else 0.0
        if len(law.columns) <= most and loss < left.get(key, np.inf):
            found[key], left[key] = law, loss
    return replace(columns, families=list(found.values()))
