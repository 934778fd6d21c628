"""Alternatives to a selected law: its nominal p-value, and what else could stand in its place."""

from __future__ import annotations

from scipy.stats import chi2

from sim2real.diagnose.engine.forward_selection import ForwardSelection, Gain
from sim2real.diagnose.engine.law import Law, Model
from sim2real.diagnose.engine.problem import DesignMatrix
from sim2real.diagnose.engine.tuned import ENGINE
from sim2real.diagnose.result.result import Alternative


def nominal_p(selection: ForwardSelection, model: Model, law: Law, screen: DesignMatrix) -> float:
    """Nominal p-value of a law of the model: a likelihood-ratio test with as many degrees of freedom as it has columns,
    times the number of laws tried in the design matrix `screen` (Bonferroni). Since selection and test share data, it
    is not calibrated; whether a law is named does not rest on it."""
    gained = selection.fitted_loss(model.minus(law)) - selection.fitted_loss(model)
    tried = sum(one.searched for one in (*screen.listed, *screen.families))
    return float(min(max(tried * chi2.sf(gained, len(law.columns)), 1e-300), 1.0))


def compare(
    selection: ForwardSelection, model: Model, law: Law, screen: DesignMatrix
) -> tuple[tuple[str, ...], tuple[Alternative, ...]]:
    """Compare `law` with every other law of the design matrix `screen` in its place in the model: the names of listed
    laws that the data do not discriminate from it, and all alternatives with how much greater the cross-validation loss
    is, the nearest first."""
    without = model.minus(law)
    best = selection.cv_loss(model)
    also, alternatives = [], {}
    for other in (*screen.listed, *screen.families):
        if other.name in {one.name for one in model.laws} or (other.variant_of and other.variant_of == law.variant_of):
            continue
        gain = selection.gain(without, other)
        loss = float((selection.cv_loss(without) - gain.cv_loss - best).sum())
        if loss < ENGINE.ambiguity and not other.family and not law.family and selection.passes(gain):
            also.append(other.name)
        if other.name not in alternatives or loss < alternatives[other.name].loss:
            whole = float(selection.cv_loss(without).sum() - best.sum())
            more = len(other.columns) - len(law.columns)
            any_shape = bool(other.family) and not law.family
            alternatives[other.name] = Alternative(other.name, loss, _why(gain, loss, whole, more, any_shape))
    ordered = sorted(alternatives.values(), key=lambda one: one.loss)
    return tuple(dict.fromkeys(also)), tuple(ordered)


def _why(gain: Gain, loss: float, whole: float, more: int, any_shape: bool) -> str:
    """Why an alternative with this `gain` lost by `loss` of the `whole` that the selected law gains; it has `more`
    columns, and may be a smooth term of `any_shape` where the selected law is a listed one."""
    if gain.total <= 0.0:
        return "predicts held-out pieces no better than the baseline"
    if any_shape and loss < -ENGINE.ambiguity:
        return "predicts better, being of any shape: the named law does not explain all"
    if any_shape and loss < ENGINE.ambiguity:
        return "as good, but of any shape: the named law says more"
    if loss < ENGINE.ambiguity:
        return "as good: this recording cannot tell the two apart"
    share = max(1.0 - loss / whole, 0.0)
    if share > ENGINE.nearly_as_good:
        return f"nearly as good, {f'with {more} more parameters' if more > 0 else 'but surely a little worse'}"
    return f"explains {100 * share:.0f} % of what the winner does"
