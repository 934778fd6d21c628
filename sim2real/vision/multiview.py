"""The report's multi-view procedure (B.4): cameras, markers, surface and frame from several views at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.vision.camera_file import Setup
from sim2real.vision.residuals import PLACE_STD, Problem
from sim2real.vision.robust_fit import Evaluate, Fitted, robust_fit
from sim2real.vision.scene import Scene
from sim2real.vision.start import start
from sim2real.vision.view import View

FEWEST_VIEWS = 2
FEWEST_MARKERS = 3
WRONG = 3.5  # times the typical error: of 108 points that are measured alike, 0.2 lie farther off by chance


@dataclass(frozen=True)
class Solved:
    """The joint fit: `poses` (views, 6), the scene, and its residuals: `off`, of each view how far on the table (n, 2)
    [m] each measured point is seen from where it is stated to be; `wrong`, of each view which points (n,) are farther
    off than measuring them explains; `corner_rms` [pixels] of each view."""

    problem: Problem
    fitted: Fitted
    poses: np.ndarray
    scene: Scene
    off: list[np.ndarray]
    wrong: list[np.ndarray]
    corner_rms: list[float]

    def scene_covariance(self) -> np.ndarray:
        """Covariance of the scene's vector."""
        many = self.poses.size
        return self.fitted.covariance[many:, many:]


def solve(setup: Setup, views: tuple[View, ...]) -> Solved:
    """Fit all at once. ValueError, in one line, if the views do not suffice."""
    if len(views) < FEWEST_VIEWS:
        raise ValueError(f"{len(views)} view is given; expected {FEWEST_VIEWS} at least, better 3 from apart")
    poses, scene = start(setup.camera, views, setup.puck_top, (setup.length / 2.0, setup.width / 2.0))
    if len(scene.markers) < FEWEST_MARKERS:
        raise ValueError(
            f"{len(scene.markers)} markers are seen in two views or more; expected {FEWEST_MARKERS} at least"
        )
    problem = Problem(setup.camera, views, scene, setup.puck_top)
    pairs = sum(len(view.pixels) + len(problem.corners(view)) for view in views)

    def at(vector: np.ndarray) -> Evaluate:
        whitening = problem.whitening(vector)
        return lambda x: problem.evaluate(x, whitening)

    fitted = robust_fit(at, np.concatenate([poses.ravel(), scene.vector()]), pairs)
    found, scene = problem.split(fitted.vector)
    return Solved(problem, fitted, found, scene, *_parts(problem, fitted))


def _parts(problem: Problem, fitted: Fitted) -> tuple[list[np.ndarray], list[np.ndarray], list[float]]:
    """The residuals of each view: points on the table, which of them are wrong, and corners in the picture."""
    poses, scene = problem.split(fitted.vector)
    off, wrong, corner_rms = [], [], []
    for view, pose in zip(problem.views, poses, strict=True):
        pixels = problem.pixels(view, pose, scene)
        n = len(view.pixels)
        by_place = problem.by_place(view, pose, scene)
        off.append(np.linalg.solve(by_place, (view.pixels - pixels[:n])[:, :, None])[:, :, 0])
        wrong.append(np.hypot(*off[-1].T) > WRONG * fitted.spread * PLACE_STD)
        corner_rms.append(float(np.sqrt(((pixels[n:] - problem.corners(view)) ** 2).sum(axis=1).mean())))
    return off, wrong, corner_rms
