"""Fitted parameters by their labels in the format of a diagnosis."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.least_squares import LeastSquaresFit
from sim2real.diagnose.result.result import Estimate

Numbers = Mapping[str, Estimate]


def labelled(law: Law, fit: LeastSquaresFit) -> Numbers:
    """Return the fitted parameters of a mechanism by the labels of its effect, or by those of the format."""
    return SPECIAL.get(law.name, _fitted_numbers)(law, fit)


def _fitted_numbers(law: Law, fit: LeastSquaresFit) -> Numbers:
    return {label: fit.estimate(row.name) for label, row in EFFECTS[law.name].rows.items() if row.name in fit.free}


def _falling(base: str) -> Callable[[Law, LeastSquaresFit], Numbers]:
    return lambda law, fit: {"e0": fit.estimate(base), **_fitted_numbers(law, fit)}


def _tangential(law: Law, fit: LeastSquaresFit) -> Numbers:
    e, ratio = (float(fit.values[name]) for name in ("wall_restitution", "tangential_ratio"))
    e_t = _derived(fit, ratio * e, {"wall_restitution": ratio, "tangential_ratio": e})
    return {"e_n": fit.estimate("wall_restitution"), "e_t": e_t}


def _odd_wall(law: Law, fit: LeastSquaresFit) -> Numbers:
    """The finding's `where` names the wall."""
    (row,) = law.columns
    return {"delta": fit.estimate(row)}


def _angles(law: Law, fit: LeastSquaresFit) -> Numbers:
    """The angle of each wall, and first that of the wall that is turned most; the finding's `where` names those."""
    numbers = _fitted_numbers(law, fit)
    return {"angle": max(numbers.values(), key=lambda one: abs(one.value)), **numbers}


def _posts(law: Law, fit: LeastSquaresFit) -> Numbers:
    rows = ("wall_restitution", "post_extra")
    return {"e": _derived(fit, sum(float(fit.values[name]) for name in rows), dict.fromkeys(rows, 1.0))}


def _headings(law: Law, fit: LeastSquaresFit) -> Numbers:
    """Add the ratio of friction along x to that along y, if the interval excludes zero friction along y."""
    numbers, grain = _fitted_numbers(law, fit), fit.estimate("friction_anisotropy")
    if grain.high >= 1.0:
        return numbers
    value, low, high = ((1.0 + one) / (1.0 - one) for one in (grain.value, grain.low, grain.high))
    return {**numbers, "ratio": Estimate(value, low, high, "1")}


def _derived(fit: LeastSquaresFit, value: float, slopes: Mapping[str, float]) -> Estimate:
    """Return a restitution derived from fitted parameters, with its derivatives `slopes` by them."""
    half = fit.reach(slopes)
    return Estimate(value, value - half, value + half, "1")


SPECIAL: dict[str, Callable[[Law, LeastSquaresFit], Numbers]] = {
    "speed_dependent_restitution": _falling("wall_restitution"),
    "mallet_speed_restitution": _falling("mallet_restitution"),
    "tangential_restitution": _tangential,
    "wall_to_wall_restitution": _odd_wall,
    "wall_alignment": _angles,
    "corner_restitution": _posts,
    "friction_anisotropy": _headings,
}
