"""The glide figures of a report: residual accelerations before and after the fit, and a curve for each finding."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from puckpilot_env.parameters import BY_NAME
from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.formula.search import Formula
from sim2real.diagnose.regimes.sliding.forces.basis_library import basis_of, force
from sim2real.diagnose.regimes.sliding.forces.motion import Motion
from sim2real.diagnose.regimes.sliding.local_accelerations import (
    acceleration_windows,
    mean_motion,
    missing_acceleration,
)
from sim2real.diagnose.regimes.sliding.problem import GlideProblem
from sim2real.diagnose.regimes.sliding.trajectory import accelerations
from sim2real.diagnose.regimes.sliding.tuned import SLIDING
from sim2real.diagnose.regimes.sliding.views import COORDINATES, Projection, listed_view, varied
from sim2real.diagnose.result.result import Curve, Mismatch
from sim2real.statistics.binned import FIGURES, Binned, binned, half_band, over
from sim2real.statistics.intervals import reach_of_launches


def mismatch(problem: GlideProblem, found: SearchResult) -> Mismatch:
    """Residual accelerations of windows under the refitted baseline and under the final law."""
    windows = acceleration_windows(problem.data)
    at_windows = mean_motion(problem, windows, found.baseline.values)
    before = missing_acceleration(problem, windows, found.baseline.values)
    after = missing_acceleration(problem, windows, found.all_values, _force_without_effect(problem, found))
    first, last = (
        np.stack([(at_windows.along * a).sum(axis=1), (at_windows.across * a).sum(axis=1)], axis=1)
        for a in (before, after)
    )
    std = np.stack([np.hypot(*(axes * windows.std).T) for axes in (at_windows.along, at_windows.across)], axis=1)
    return Mismatch(
        "windows of motion", "acceleration", "m/s²", ("along the motion", "to its left"), first, last, std,
        {label: column(at_windows) for label, column in COORDINATES.values()},
        at_windows.place, at_windows.along, (float(at_windows.size[0]), float(at_windows.size[1])),
    )  # fmt: skip


def listed_curve(problem: GlideProblem, found: SearchResult, mechanism: str) -> Curve:
    """The acceleration that a listed mechanism adds, over the coordinate that shows it best.

    All other coordinates are held fixed; data points are the curve plus the residuals of the final law.
    """
    values = dict(found.final.values)
    free = [name for name in found.final.free if name in EFFECTS[mechanism].row_names]
    windows = acceleration_windows(problem.data)
    at_windows, look = mean_motion(problem, windows, found.all_values), listed_view(mechanism, values)
    rest = look.of(
        at_windows, missing_acceleration(problem, windows, found.all_values, _force_without_effect(problem, found))
    )
    x, std = look.coordinate(at_windows), np.hypot(*(look.direction(at_windows) * windows.std).T)
    points = binned(x, rest, std)
    index = [found.final.free.index(name) for name in free]
    spread = found.final.covariance[np.ix_(index, index)]

    def added(to: np.ndarray, law: Mapping[str, float]) -> np.ndarray:
        at = varied(mechanism, values, at_windows, to)
        without = {**values, **{name: BY_NAME[name].default for name in EFFECTS[mechanism].row_names}}
        return look.of(at, accelerations(law, at) - accelerations(without, at))

    grid = np.linspace(float(x.min()), float(x.max()), FIGURES.drawn)
    law, slopes = added(grid, values), np.zeros((FIGURES.drawn, len(free)))
    for k, (name, size) in enumerate(zip(free, np.sqrt(np.diag(spread)), strict=True)):
        beside = _near(name, values[name], size)
        slopes[:, k] = (added(grid, {**values, name: beside}) - law) / (beside - values[name])
    half = reach_of_launches(found.law.clusters) * np.sqrt(
        np.maximum(np.einsum("gi,ij,gj->g", slopes, spread, slopes), 0.0)
    )
    drawn = replace(points, y=points.y + added(points.x, values))
    return _curve(look, replace(points, x=grid, y=law), half, drawn)


def smooth_curve(
    problem: GlideProblem, found: SearchResult, law: Law, formula: Formula, looks: list[Projection]
) -> Curve:
    """An unlisted law and its readable formula, in the projection of `looks` in which the law is largest.

    Data points are the curve plus the residuals of the final law, because the law may vary within a window.
    """
    frames = problem.motion(problem.linearized(found.all_values)[0])
    block = basis_of(law.name)(frames)
    spread = found.theta_covariance[-len(law.columns) :, -len(law.columns) :]
    added, equal = force(law.name, frames, found.coefficients), np.ones(len(frames.t))
    look = max(looks, key=lambda one: _size(one, frames, added))
    windows = acceleration_windows(problem.data, SLIDING.short_window if law.family == "history" else None)
    at_windows = mean_motion(problem, windows, found.all_values)
    std = np.hypot(*(look.direction(at_windows) * windows.std).T)
    rest = missing_acceleration(problem, windows, found.all_values, _force_without_effect(problem, found))
    points = binned(look.coordinate(at_windows), look.of(at_windows, rest), std)
    x = look.coordinate(frames)
    shape = binned(x, look.of(frames, added), equal, SLIDING.law_bins)
    points = replace(points, y=points.y + np.interp(points.x, shape.x, shape.y))
    columns = np.einsum("na,nak->nk", look.direction(frames), block)
    fitted = formula.form.field(formula.values) + _beside(found, formula, frames)
    readable = over(shape.members, x, look.of(frames, fitted), equal)
    return replace(
        _curve(look, shape, half_band(shape, equal, columns, spread, found.law.clusters), points), formula=readable.y
    )


def _beside(found: SearchResult, formula: Formula, frames: Motion) -> np.ndarray:
    """The force (n, 2) [m/s^2] due to the changes of the other fitted parameters when the formula is fitted."""
    moved = dict(zip(found.final.free, map(float, formula.moved), strict=True))
    values = {**found.final.values, **{name: found.final.values[name] + by for name, by in moved.items()}}
    change = accelerations(values, frames) - accelerations(found.final.values, frames)
    return change - moved.get("drag", 0.0) * (frames.velocity**2).sum(axis=1)[:, None] * frames.along


def _force_without_effect(problem: GlideProblem, found: SearchResult) -> np.ndarray | None:
    """The force (n, 2) [m/s^2] of an unlisted law at each frame if the simulator has no effect for it, else None."""
    if found.unlisted is None or found.effect_parameters():
        return None
    frames = problem.motion(problem.linearized(found.final.values)[0])
    return force(found.unlisted.name, frames, found.coefficients)


def _near(name: str, value: float, size: float) -> float:
    """A value near that of a parameter and within its range, for a difference."""
    step = max(0.1 * size, 1e-6)
    return value + step if value + step < BY_NAME[name].high else value - step


def _size(look: Projection, frames: Motion, force: np.ndarray) -> float:
    """Mean square [m^2/s^4] of the binned projection of a force (n, 2)."""
    shape = binned(look.coordinate(frames), look.of(frames, force), np.ones(len(frames.t)), SLIDING.law_bins)
    return float(np.mean(shape.y**2)) if len(shape.y) else 0.0


def _curve(look: Projection, law: Binned, half: np.ndarray, points: Binned) -> Curve:
    return Curve(
        look.label, f"acceleration {look.component} [m/s²]", law.x, law.y, law.y - half, law.y + half,
        points.x, points.y, points.error,
    )  # fmt: skip
