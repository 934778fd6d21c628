"""The nominal p-value of a selected law, and the alternatives that could replace it."""

from __future__ import annotations

from scipy.stats import chi2

from sim2real.diagnose.engine.forward_selection import ForwardSelection, Gain
from sim2real.diagnose.engine.law import Law, Model
from sim2real.diagnose.engine.problem import DesignMatrix
from sim2real.diagnose.engine.tuned import ENGINE
from sim2real.diagnose.result.result import Alternative


def nominal_p(selection: ForwardSelection, model: Model, law: Law, screen: DesignMatrix) -> float:
    """Return the nominal p-value of a law of the model.

    It is that of a likelihood-ratio test with one degree of freedom per column, times the number of laws tried in the
    design matrix `screen` (Bonferroni). It is not calibrated, since selection and test share data; no decision uses it.
    """
    gained = selection.fitted_loss(model.minus(law)) - selection.fitted_loss(model)
    tried = sum(one.searched for one in (*screen.listed, *screen.families))
    return float(min(max(tried * chi2.sf(gained, len(law.columns)), 1e-300), 1.0))


def compare(
    selection: ForwardSelection, model: Model, law: Law, screen: DesignMatrix
) -> tuple[tuple[str, ...], tuple[Alternative, ...]]:
    """Compare `law` with every other law of the design matrix `screen` in its place in the model.

    Returns the names of listed laws that the data do not discriminate from it, and all alternatives with the increase
    of the cross-validation loss, in ascending order.
    """
    without = model.minus(law)
    best = selection.cv_loss(model)
    also, alternatives = [], {}
    for other in (*screen.listed, *screen.families):
        if other.name in {one.name for one in model.laws} or (other.variant_of and other.variant_of == law.variant_of):
            continue
        gain = selection.gain(without, other)
        loss = float((selection.cv_loss(without) - gain.by_launch - best).sum())
        if loss < ENGINE.ambiguity and not other.family and not law.family and selection.passes(gain):
            also.append(other.name)
        if other.name not in alternatives or loss < alternatives[other.name].loss:
            total = float(selection.cv_loss(without).sum() - best.sum())
            more = len(other.columns) - len(law.columns)
            nonparametric = bool(other.family) and not law.family
            alternatives[other.name] = Alternative(other.name, loss, _reason(gain, loss, total, more, nonparametric))
    ordered = sorted(alternatives.values(), key=lambda one: one.loss)
    return tuple(dict.fromkeys(also)), tuple(ordered)


def _reason(gain: Gain, loss: float, total: float, more: int, nonparametric: bool) -> str:
    """Return why an alternative with this `gain` was not chosen.

    `loss`: increase of the cross-validation loss; `total`: gain of the selected law; `more`: additional columns of the
    alternative; `nonparametric`: whether it is a smooth term and the selected law is a listed one.
    """
    if gain.total <= 0.0:
        return "no better than the baseline in cross-validation"
    if nonparametric and loss < -ENGINE.ambiguity:
        return "predicts better, but is nonparametric: the named law does not explain all"
    if nonparametric and loss < ENGINE.ambiguity:
        return "equivalent, but nonparametric: the named law is more specific"
    if loss < ENGINE.ambiguity:
        return "equivalent: these data do not discriminate the two"
    share = max(1.0 - loss / total, 0.0)
    if share > ENGINE.nearly_as_good:
        return f"nearly as good, {f'with {more} more parameters' if more > 0 else 'but significantly worse'}"
    return f"explains {100 * share:.0f} % of what the selected model explains"
