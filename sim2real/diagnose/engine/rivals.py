"""How sure a law is, and what else could stand in its place."""

from __future__ import annotations

from scipy.stats import chi2

from sim2real.diagnose.engine.choose import AMBIGUOUS, Chooser, Gain, Model
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.finding import Rival
from sim2real.diagnose.problem import Columns


def chance(chooser: Chooser, model: Model, law: Law, screen: Columns) -> float:
    """Nominal chance that noise alone gains as much: that of a chi-square, times the number of laws tried. The best law
    is no drawn one, so that it is no calibrated p-value; whether a law is named does not rest on it."""
    gained = chooser.fitted(model.minus(law)) - chooser.fitted(model)
    tried = sum(one.searched for one in (*screen.listed, *screen.families))
    return float(min(max(tried * chi2.sf(gained, len(law.columns)), 1e-300), 1.0))


def compare(chooser: Chooser, model: Model, law: Law, screen: Columns) -> tuple[tuple[str, ...], tuple[Rival, ...]]:
    """What could stand in the place of `law`: names that the data cannot tell from it, and the rivals that lost."""
    without = model.minus(law)
    best = chooser.foretold(model)
    also, rivals = [], {}
    for other in (*screen.listed, *screen.families):
        if other.name in {one.name for one in model.laws} or (other.among and other.among == law.among):
            continue
        gain = chooser.gain(without, other)
        loss = float((chooser.foretold(without) - gain.foretold - best).sum())
        if loss < AMBIGUOUS and not other.family and not law.family and chooser.passes(gain):
            also.append(other.name)
        if other.name not in rivals or loss < rivals[other.name].loss:
            whole = float(chooser.foretold(without).sum() - best.sum())
            more = len(other.columns) - len(law.columns)
            freer = bool(other.family) and not law.family
            rivals[other.name] = Rival(other.name, loss, _why(gain, loss, whole, more, freer))
    ordered = sorted(rivals.values(), key=lambda rival: rival.loss)
    return tuple(dict.fromkeys(also)), tuple(ordered)


def _why(gain: Gain, loss: float, whole: float, more: int, freer: bool) -> str:
    """Why a rival lost by `loss` of the `whole` that the winner foretells better; it has `more` numbers, and may be
    `freer`, of any shape, where the winner has a name."""
    if gain.total <= 0.0:
        return "foretells held-out pieces no better than the baseline"
    if freer and loss < -AMBIGUOUS:
        return "foretells more, being of any shape: the law that has a name does not explain all"
    if freer and loss < AMBIGUOUS:
        return "as good, but of any shape: the law that has a name says more"
    if loss < AMBIGUOUS:
        return "as good: this recording cannot tell the two apart"
    share = max(1.0 - loss / whole, 0.0)
    if share > 0.995:
        return f"nearly as good, with {more} more numbers" if more > 0 else "nearly as good, but surely a little worse"
    return f"explains {100 * share:.0f} % of what the winner does"
