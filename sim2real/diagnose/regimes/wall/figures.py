"""The wall figures of a report: residuals before and after the fit, and a curve for each finding."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from puckpilot_env.parameters import BY_NAME
from puckpilot_env.physics.contacts import bounce
from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.formula.search import Formula
from sim2real.diagnose.regimes.contact.candidates import components_of
from sim2real.diagnose.regimes.contact.formula import NORMAL, TANGENT, ContactProjection
from sim2real.diagnose.regimes.contact.tuned import CONTACT
from sim2real.diagnose.regimes.wall.basis_library import added_shares
from sim2real.diagnose.regimes.wall.data import KINDS, WallContacts, place_along_wall
from sim2real.diagnose.regimes.wall.problem import WallProblem
from sim2real.diagnose.result.result import Curve, Mismatch
from sim2real.statistics.binned import binned, half_band, is_rough, over, singles

KEPT = ("share of the normal speed kept", "share of the tangential speed kept")
TICKS = (*KINDS, "posts")


@dataclass(frozen=True)
class _KeptShare:
    """The share (n,) of a component that is kept under the final law, its derivatives (n, f) by the fitted
    coefficients, and their covariance (f, f)."""

    law: np.ndarray
    slopes: np.ndarray
    covariance: np.ndarray


def mismatch(problem: WallProblem, found: SearchResult) -> Mismatch:
    """Velocity residuals (observed minus predicted) after each contact, for the refitted baseline and the final law."""
    d, std = problem.data, problem.std
    before, after = (_residuals(problem, values) * std for values in (found.baseline.values, found.final.values))
    if found.unlisted is not None:
        components, shares = list(components_of(found.unlisted)), added_shares(d, found.unlisted)
        after[:, components] -= d.approach[:, components] * (shares @ found.coefficients)[:, None]
    by = {label: column for label, column in coordinates(d).values()}
    return Mismatch(
        "wall contacts", "velocity after the contact", "m/s", ("normal", "along the wall"), before, after, std, by,
        d.place, d.normal, problem.size,
    )  # fmt: skip


def listed_curve(problem: WallProblem, found: SearchResult, mechanism: str) -> Curve:
    """The kept share under the final law and in the data, over the coordinate that shows the mechanism best.

    If the law depends on more than that coordinate, the observed share is drawn over the predicted one.
    """
    return _curve(problem, found, _listed_projection(problem.data, mechanism))


def smooth_curve(problem: WallProblem, found: SearchResult, formula: Formula, view: ContactProjection) -> Curve:
    """The kept share under an unlisted law and in the data, together with its readable formula."""
    return _curve(problem, found, view, formula)


def _listed_projection(d: WallContacts, mechanism: str) -> ContactProjection:
    along = coordinates(d)
    if mechanism == "wall_to_wall_restitution":
        order = [*KINDS.values(), bounce.POST]
        return ContactProjection("wall", np.array([order.index(kind) for kind in d.kind], float), NORMAL, TICKS)
    if mechanism == "corner_restitution":
        return ContactProjection("post or wall", (d.kind == bounce.POST).astype(float), NORMAL, ("walls", "posts"))
    if mechanism == "tangential_restitution":
        return ContactProjection("tangential speed before [m/s]", np.abs(d.tangential_velocity), TANGENT)
    if mechanism == "wall_friction_spin":
        return ContactProjection(*along["heading"], TANGENT)
    return ContactProjection(*along["speed"], NORMAL)


def coordinates(d: WallContacts) -> dict[str, tuple[str, np.ndarray]]:
    """Label and values (n,) of each coordinate, by the quantity that a law may depend on (`Law.family`)."""
    return {
        "speed": ("normal speed before [m/s]", d.closing_speed),
        "heading": ("angle from the normal [°]", np.degrees(d.incidence_angle)),
        "position": ("place along its wall [m]", place_along_wall(d)),
        "time": ("time [s]", d.t),
        "history": ("time since the last contact [s]", d.time_since_contact),
    }


def _residuals(problem: WallProblem, values: Mapping[str, float]) -> np.ndarray:
    """Residuals (n, 2) of a law in units of the noise."""
    return problem.residuals(values, (), np.arange(problem.clusters)).r.reshape(-1, 2)


def _curve(problem: WallProblem, found: SearchResult, view: ContactProjection, formula: Formula | None = None) -> Curve:
    """The kept share under the final law with its smooth term, and in the data."""
    d, component = problem.data, view.component
    speed = d.approach[:, component]
    use = np.isfinite(view.coordinate) & (np.abs(speed) > CONTACT.least_speed)
    if found.final.values.get("wall_mu", 0.0) > 0.0 and (use & ~d.spin_unknown).any():
        use &= ~d.spin_unknown  # contacts with a known spin, if there are any
    speed, rows, x = np.where(use, speed, np.nan), np.flatnonzero(use), view.coordinate[use]
    kept = _kept_share(problem, found, component, speed)
    law, std = kept.law[rows], (problem.std[:, component] / np.abs(speed))[rows]
    observed = (d.components(d.velocity_after)[:, component] / speed)[rows]
    rough = not view.ticks and is_rough(x, law, std)
    x_label, y_label = view.label, KEPT[component]
    if rough and formula is None:  # a law of more than one coordinate is not a curve over one of them
        x, x_label, y_label = law, f"{y_label}, predicted", f"{y_label}, observed"
    points = binned(x, observed, std)
    if view.ticks:
        points = over(np.array([x == k for k in range(len(view.ticks)) if (x == k).any()]), x, observed, std)
    shape = over(points.members if rough or view.ticks else singles(x), x, law, std)
    half = half_band(shape, std, kept.slopes[rows], kept.covariance, found.law.clusters)
    by_formula = None
    if formula is not None:
        share = _share_of_formula(problem, found, formula, component, speed)[rows]
        by_formula = over(shape.members, x, share, std).y
    return Curve(
        x_label, y_label, shape.x, shape.y, shape.y - half, shape.y + half, points.x, points.y, points.error,
        view.ticks, by_formula,
    )  # fmt: skip


def _share_of_formula(
    problem: WallProblem, found: SearchResult, formula: Formula, component: int, speed: np.ndarray
) -> np.ndarray:
    """The share (n,) of a component that is kept under a formula, with the law's other parameters refitted."""
    moved = zip(found.final.free, formula.moved, strict=True)
    refitted = {name: found.final.values[name] + float(by) for name, by in moved}
    without = problem.predicted({**found.final.values, **refitted})[:, component]
    return (without + formula.form.field(formula.values)[:, component]) / speed


def _kept_share(problem: WallProblem, found: SearchResult, component: int, speed: np.ndarray) -> _KeptShare:
    """The kept share of a component with the `speed` (n,) [m/s] before, under the final law."""
    values, covariance = found.final.values, found.final.covariance
    law = problem.predicted(values)[:, component] / speed
    slopes = []
    for k, name in enumerate(found.final.free):
        step = max(0.1 * float(np.sqrt(covariance[k, k])), 1e-6)
        step = step if values[name] + step < BY_NAME[name].high else -step
        moved = problem.predicted({**values, name: values[name] + step})[:, component] / speed
        slopes.append((moved - law) / step)
    columns = np.stack(slopes, axis=1)
    if found.unlisted is None:
        return _KeptShare(law, columns, covariance)
    shares = added_shares(problem.data, found.unlisted) * float(component in components_of(found.unlisted))
    return _KeptShare(
        law + shares @ found.coefficients, np.concatenate([columns, shares], axis=1), found.theta_covariance
    )
