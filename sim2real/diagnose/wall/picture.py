"""What a report shows of the bounces: where the law fails before and after, and each finding as a curve."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from puckpilot_env.parameters import BY_NAME
from puckpilot_env.physics import bounce
from sim2real.diagnose.binned import binned, half_band, is_rough, over, singles
from sim2real.diagnose.contact_laws import SLOWEST, acted_on
from sim2real.diagnose.engine.explain import Explained
from sim2real.diagnose.finding import Curve, Parting
from sim2real.diagnose.formula import Formula
from sim2real.diagnose.wall.data import KINDS, Bounces
from sim2real.diagnose.wall.families import shares
from sim2real.diagnose.wall.problem import WallProblem

NORMAL, TANGENT = 0, 1
KEPT = ("share of the normal speed kept", "share of the tangential speed kept")
PLACES = (*KINDS, "posts")


@dataclass(frozen=True)
class View:
    """What is kept of one `component`, along a `coordinate` (n,); nan where a bounce is to be left out."""

    label: str
    coordinate: np.ndarray
    component: int
    ticks: tuple[str, ...] = ()


def parting(problem: WallProblem, found: Explained) -> Parting:
    """Velocities after each bounce that the refitted baseline and the final law do not foretell."""
    d, std = problem.data, problem.std
    before, after = (_misses(problem, values) * std for values in (found.baseline.values, found.final.values))
    if found.unlisted is not None:
        components, weights = list(acted_on(found.unlisted)), shares(d, found.unlisted)
        after[:, components] -= speeds(d)[:, components] * (weights @ found.coefficients)[:, None]
    by = {label: column for label, column in coordinates(d).values()}
    return Parting(
        "bounces", "velocity after the bounce", "m/s", ("normal", "along the wall"), before, after, std, by,
        d.place, d.normal, problem.size,
    )  # fmt: skip


def listed_curve(problem: WallProblem, found: Explained, mechanism: str) -> Curve:
    """What is kept of the speed under the final law and in the data, by the coordinate that shows the mechanism; what
    is seen against what the law foretells, where that depends on more."""
    view = _listed_view(problem.data, mechanism)
    return _curve(problem, found, view)


def smooth_curve(problem: WallProblem, found: Explained, formula: Formula, view: View) -> Curve:
    """The same for an unlisted law, beside its readable formula."""
    return _curve(problem, found, view, formula)


def _listed_view(d: Bounces, mechanism: str) -> View:
    along = coordinates(d)
    if mechanism == "wall_to_wall_restitution":
        order = [*KINDS.values(), bounce.POST]
        return View("wall", np.array([order.index(kind) for kind in d.kind], float), NORMAL, PLACES)
    if mechanism == "corner_restitution":
        return View("post or wall", (d.kind == bounce.POST).astype(float), NORMAL, ("walls", "posts"))
    if mechanism == "tangential_restitution":
        return View("tangential speed before [m/s]", np.abs(d.sliding), TANGENT)
    if mechanism == "wall_friction_spin":
        return View(*along["heading"], TANGENT)
    return View(*along["speed"], NORMAL)


def coordinates(d: Bounces) -> dict[str, tuple[str, np.ndarray]]:
    """What a bounce may depend on, with labels; the place is the one along its wall."""
    ends = np.isin(d.kind, (KINDS["x0"], KINDS["x1"]))
    return {
        "speed": ("normal speed before [m/s]", d.closing),
        "heading": ("angle from the normal [°]", np.degrees(d.angle)),
        "position": ("place along its wall [m]", np.where(ends, d.place[:, 1], d.place[:, 0])),
        "time": ("time [s]", d.t),
        "history": ("time since the last contact [s]", d.since),
    }


def speeds(d: Bounces) -> np.ndarray:
    """Speeds (n, 2) before, towards the wall and along it [m/s]."""
    return np.stack([d.closing, d.sliding], axis=1)


def _misses(problem: WallProblem, values: Mapping[str, float]) -> np.ndarray:
    """Residuals (n, 2) of a law in units of the noise."""
    return problem.residuals(values, (), np.arange(problem.clusters)).r.reshape(-1, 2)


def _curve(problem: WallProblem, found: Explained, view: View, formula: Formula | None = None) -> Curve:
    """A view of the final law, smooth part and all, and of the data."""
    d, at = problem.data, view.component
    going = speeds(d)[:, at]
    use = np.isfinite(view.coordinate) & (np.abs(going) > SLOWEST)
    if found.final.values.get("wall_mu", 0.0) > 0.0 and (use & ~d.lost).any():
        use &= ~d.lost  # of pucks whose spin is known, if there are any
    safe = np.where(use, going, np.nan)
    law, columns, spread = _kept(problem, found, at, safe)
    seen, std = d.split(d.after)[:, at] / safe, problem.std[:, at] / np.abs(safe)
    x, rows = view.coordinate[use], np.flatnonzero(use)
    rough = not view.ticks and is_rough(x, law[rows], std[rows])
    x_label, y_label = view.label, KEPT[at]
    if rough and formula is None:  # a law of more than one thing is no curve over any
        x, x_label, y_label = law[rows], f"{KEPT[at]}, by the law", f"{KEPT[at]}, as seen"
    points = binned(x, seen[rows], std[rows])
    if view.ticks:
        points = over(np.array([x == k for k in range(len(view.ticks)) if (x == k).any()]), x, seen[rows], std[rows])
    shape = over(points.members if rough or view.ticks else singles(x), x, law[rows], std[rows])
    half = half_band(shape, std[rows], columns[rows], spread, found.law.clusters)
    said = None
    if formula is not None:
        moved = zip(found.final.free, formula.moved, strict=True)
        beside = {name: found.final.values[name] + float(by) for name, by in moved}
        plain = problem.predicted({**found.final.values, **beside})[:, at]
        with_it = (plain + formula.form.field(formula.values)[:, at]) / safe
        said = over(shape.members, x, with_it[rows], std[rows]).y
    return Curve(
        x_label, y_label, shape.x, shape.y, shape.y - half, shape.y + half, points.x, points.y, points.error,
        view.ticks, said,
    )  # fmt: skip


def _kept(problem: WallProblem, found: Explained, at: int, speeds: np.ndarray):
    """The share (n,) of a component that the final law keeps, its slopes (n, f) by what was fitted, the covariance of
    that."""
    values, spread = found.final.values, found.final.covariance
    plain = problem.predicted(values)[:, at] / speeds
    slopes = []
    for k, name in enumerate(found.final.free):
        step = max(0.1 * float(np.sqrt(spread[k, k])), 1e-6)
        step = step if values[name] + step < BY_NAME[name].high else -step
        slopes.append((problem.predicted({**values, name: values[name] + step})[:, at] / speeds - plain) / step)
    columns = np.stack(slopes, axis=1)
    if found.unlisted is None:
        return plain, columns, spread
    weights = shares(problem.data, found.unlisted) * float(at in acted_on(found.unlisted))
    smooth = weights @ found.coefficients
    return plain + smooth, np.concatenate([columns, weights], axis=1), found.theta_covariance
