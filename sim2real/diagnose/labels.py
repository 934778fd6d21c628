"""Fitted parameters under the names that the format of a diagnosis gives them."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine.fit import Fit
from sim2real.diagnose.finding import Estimate


def labelled(mechanism: str, fit: Fit) -> Mapping[str, Estimate]:
    """The parameters of a mechanism that a fit freed, by the labels of its effect; some in the words of the format."""
    if mechanism in SPECIAL:
        return SPECIAL[mechanism](fit)
    return _freed(mechanism, fit)


def _shifted(one: Estimate, by: float) -> Estimate:
    return Estimate(one.value + by, one.low + by, one.high + by, one.unit)


def _scaled(one: Estimate, by: float) -> Estimate:
    low, high = sorted((one.low * by, one.high * by))
    return Estimate(one.value * by, low, high, one.unit)


def _falling(mechanism: str, base: str) -> Callable[[Fit], dict[str, Estimate]]:
    return lambda fit: {"e0": fit.estimate(base), **_freed(mechanism, fit)}


def _freed(mechanism: str, fit: Fit) -> dict[str, Estimate]:
    return {label: fit.estimate(row.name) for label, row in EFFECTS[mechanism].rows.items() if row.name in fit.free}


def _tangential(fit: Fit) -> dict[str, Estimate]:
    e = fit.estimate("wall_restitution")
    return {"e_n": e, "e_t": _scaled(fit.estimate("tangential_ratio"), e.value)}


def _odd_wall(fit: Fit) -> dict[str, Estimate]:
    rows = EFFECTS["wall_to_wall_restitution"].rows
    return {f"delta_{wall}": fit.estimate(row.name) for wall, row in rows.items() if row.name in fit.free}


def _posts(fit: Fit) -> dict[str, Estimate]:
    return {"e": _shifted(fit.estimate("post_extra"), float(fit.values["wall_restitution"]))}


def _headings(fit: Fit) -> dict[str, Estimate]:
    one = fit.estimate("friction_anisotropy")
    value, low, high = ((1.0 + r) / (1.0 - r) for r in (one.value, one.low, one.high))
    return {**_freed("friction_anisotropy", fit), "ratio": Estimate(value, low, high, "1")}


SPECIAL: dict[str, Callable[[Fit], Mapping[str, Estimate]]] = {
    "speed_dependent_restitution": _falling("speed_dependent_restitution", "wall_restitution"),
    "mallet_speed_restitution": _falling("mallet_speed_restitution", "mallet_restitution"),
    "tangential_restitution": _tangential,
    "wall_to_wall_restitution": _odd_wall,
    "corner_restitution": _posts,
    "friction_anisotropy": _headings,
}
