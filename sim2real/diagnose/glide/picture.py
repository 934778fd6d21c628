"""What a report shows of the glides: where the law fails before and after, and each finding as a curve."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from puckpilot_env.parameters import BY_NAME
from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.binned import DRAWN, Binned, binned, half_band, over
from sim2real.diagnose.engine.explain import Explained
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.finding import Curve, Parting
from sim2real.diagnose.formula import Formula
from sim2real.diagnose.glide.families import FAMILIES, Motion, force
from sim2real.diagnose.glide.forces import accelerations
from sim2real.diagnose.glide.problem import GlideProblem
from sim2real.diagnose.glide.views import COORDINATES, View, listed_view, varied
from sim2real.diagnose.glide.windows import missing, motion, windows
from sim2real.diagnose.interval import reach_of_launches

SHORT_SPAN = 0.3  # s of a window, where what happens soon after a contact matters
LAW_BINS = 30  # of a law's curve, which has no noise


def parting(problem: GlideProblem, found: Explained) -> Parting:
    """Accelerations that the refitted baseline and the final law do not foretell, by window."""
    some = windows(problem.data)
    seen = motion(problem, some, found.baseline.values)
    before = missing(problem, some, found.baseline.values)
    after = missing(problem, some, found.mended, _untraced(problem, found))
    first, last = (
        np.stack([(seen.along * a).sum(axis=1), (seen.across * a).sum(axis=1)], axis=1) for a in (before, after)
    )
    std = np.stack([np.hypot(*(axes * some.std).T) for axes in (seen.along, seen.across)], axis=1)
    return Parting(
        "stretches of motion", "acceleration", "m/s²", ("along the motion", "to its left"), first, last, std,
        {label: column(seen) for label, column in COORDINATES.values()},
        seen.place, seen.along, (float(seen.size[0]), float(seen.size[1])),
    )  # fmt: skip


def listed_curve(problem: GlideProblem, found: Explained, mechanism: str) -> Curve:
    """What a listed mechanism adds, by what shows it best, all else that it depends on held fixed; the data are as far
    off that as they are off the whole law."""
    values = dict(found.final.values)
    free = [name for name in found.final.free if name in EFFECTS[mechanism].row_names]
    some = windows(problem.data)
    seen, look = motion(problem, some, found.mended), listed_view(mechanism, values)
    left = look.of(seen, missing(problem, some, found.mended, _untraced(problem, found)))
    x, std = look.coordinate(seen), np.hypot(*(look.direction(seen) * some.std).T)
    points = binned(x, left, std)
    index = [found.final.free.index(name) for name in free]
    spread = found.final.covariance[np.ix_(index, index)]

    def added(to: np.ndarray, law: Mapping[str, float]) -> np.ndarray:
        at = varied(mechanism, values, seen, to)
        plain = {**values, **{name: BY_NAME[name].default for name in EFFECTS[mechanism].row_names}}
        return look.of(at, accelerations(law, at) - accelerations(plain, at))

    grid = np.linspace(float(x.min()), float(x.max()), DRAWN)
    law, slopes = added(grid, values), np.zeros((DRAWN, len(free)))
    for k, (name, size) in enumerate(zip(free, np.sqrt(np.diag(spread)), strict=True)):
        aside = _aside(name, values[name], size)
        slopes[:, k] = (added(grid, {**values, name: aside}) - law) / (aside - values[name])
    half = reach_of_launches(found.law.clusters) * np.sqrt(
        np.maximum(np.einsum("gi,ij,gj->g", slopes, spread, slopes), 0.0)
    )
    drawn = replace(points, y=points.y + added(points.x, values))
    return _curve(look, replace(points, x=grid, y=law), half, drawn)


def smooth_curve(problem: GlideProblem, found: Explained, law: Law, formula: Formula, looks: list[View]) -> Curve:
    """An unlisted law and its readable formula, from that side of `looks` from which the law is largest; the data are
    as far off the curve as they are off the whole law, which turns and changes within a stretch as no mean of it
    does."""
    frames = problem.motion(problem.linearised(found.mended)[0])
    block = FAMILIES[law.name][1](frames)
    spread = found.theta_covariance[-len(law.columns) :, -len(law.columns) :]
    pull, even = force(law.name, frames, found.coefficients), np.ones(len(frames.t))
    look = max(looks, key=lambda one: _size(one, frames, pull))
    some = windows(problem.data, SHORT_SPAN if law.family == "history" else None)
    seen = motion(problem, some, found.mended)
    std = np.hypot(*(look.direction(seen) * some.std).T)
    left = missing(problem, some, found.mended, _untraced(problem, found))
    points = binned(look.coordinate(seen), look.of(seen, left), std)
    x = look.coordinate(frames)
    shape = binned(x, look.of(frames, pull), even, LAW_BINS)
    points = replace(points, y=points.y + np.interp(points.x, shape.x, shape.y))
    columns = np.einsum("na,nak->nk", look.direction(frames), block)
    whole = formula.form.field(formula.values) + _beside(found, formula, frames)
    said = over(shape.members, x, look.of(frames, whole), even)
    return replace(
        _curve(look, shape, half_band(shape, even, columns, spread, found.law.clusters), points), formula=said.y
    )


def _beside(found: Explained, formula: Formula, frames: Motion) -> np.ndarray:
    """The force (n, 2) by which what was fitted changes beside a formula."""
    moved = dict(zip(found.final.free, map(float, formula.moved), strict=True))
    values = {**found.final.values, **{name: found.final.values[name] + by for name, by in moved.items()}}
    more = accelerations(values, frames) - accelerations(found.final.values, frames)
    return more - moved.get("drag", 0.0) * (frames.velocity**2).sum(axis=1)[:, None] * frames.along


def _untraced(problem: GlideProblem, found: Explained) -> np.ndarray | None:
    """The force (n, 2) at each frame of an unlisted law that the simulator has no place for; None where it has one."""
    if found.unlisted is None or found.switched():
        return None
    frames = problem.motion(problem.linearised(found.final.values)[0])
    return force(found.unlisted.name, frames, found.coefficients)


def _aside(name: str, value: float, size: float) -> float:
    """A parameter a little beside its value, within its range."""
    step = max(0.1 * size, 1e-6)
    return value + step if value + step < BY_NAME[name].high else value - step


def _size(look: View, frames: Motion, force: np.ndarray) -> float:
    shape = binned(look.coordinate(frames), look.of(frames, force), np.ones(len(frames.t)), LAW_BINS)
    return float(np.mean(shape.y**2)) if len(shape.y) else 0.0


def _curve(look: View, law: Binned, half: np.ndarray, points: Binned) -> Curve:
    return Curve(
        look.label, f"acceleration {look.component} [m/s²]", law.x, law.y, law.y - half, law.y + half,
        points.x, points.y, points.error,
    )  # fmt: skip
