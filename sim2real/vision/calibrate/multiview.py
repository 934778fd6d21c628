"""The report's multi-view procedure (B.4): cameras, markers, surface and bend from several views at once."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from sim2real.vision.bend import TERMS as TERMS_OF_BEND
from sim2real.vision.calibrate.pose import LOST
from sim2real.vision.calibrate.residuals import PLACE, Problem
from sim2real.vision.calibrate.robust_fit import Evaluate, Fitted, robust_fit
from sim2real.vision.calibrate.start import start
from sim2real.vision.calibrate.view import View
from sim2real.vision.camera_file import Setup
from sim2real.vision.markers import FEWEST
from sim2real.vision.motion import rotation
from sim2real.vision.scene import BEFORE, Scene
from sim2real.vision.surface import TERMS

FEWEST_VIEWS = 2
BEND_STD = 1e-3  # m, where the search for how large the bend is begins,
BEND_RANGE = (3e-5, 3e-3)  # and where it may end
ROUNDS = 8  # of that search
BEND_MOST = 6e-3  # m: a ruler's and a wall's faults are less
# m, the standard deviation of a marker: 23 mm by two real photographs whose cameras were 6 cm apart; at 40 mm places in
# a third are 3 mm off on average, 7 mm at most
PLACED_MOST = 0.04
MOST_WRONG = 1.0 / 3.0  # of a view's points, if the others are to say which
WRONG = 3.5  # standard deviations: of 108 points that are measured alike, 0.4 lie farther off by chance


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

    @property
    def bend(self) -> float:
        """How far at most [m] a measured place is from where a rigid frame has it, beyond shift, turn and scale."""
        places = np.concatenate([view.places for view in self.problem.views])
        return float(np.hypot(*(places - self.scene.bend.rigid(places)).T).max())

    def scene_covariance(self) -> np.ndarray:
        """Covariance of the scene's vector."""
        many = self.poses.size
        return self.fitted.covariance[many:, many:]

    def marker_std(self) -> np.ndarray:
        """Standard deviations (markers, 4, 3) [m] of the corners' places."""
        std = self.scene.replaced(np.sqrt(np.diag(self.scene_covariance())))
        return np.array(list(std.markers.values()))


def solve(setup: Setup, views: tuple[View, ...]) -> Solved:
    """Fit all at once. ValueError, in one line, if the views do not suffice."""
    if len(views) < FEWEST_VIEWS:
        raise ValueError(f"{len(views)} view is given; expected {FEWEST_VIEWS} at least, better 3 from apart")
    poses, scene = start(setup.camera, views, setup.puck_top, (setup.length / 2.0, setup.width / 2.0))
    if len(scene.markers) < FEWEST:
        raise ValueError(f"{len(scene.markers)} markers are seen in two views or more; expected {FEWEST} at least")
    problem = Problem(setup.camera, views, scene, setup.puck_top, BEND_STD)
    vector = np.concatenate([poses.ravel(), scene.vector()])
    fitted = _fit(problem, vector, None)
    for _ in range(ROUNDS):
        before = problem.bend_std
        problem = replace(problem, bend_std=_bend_std(fitted, poses.size, before))
        if abs(problem.bend_std - before) < 0.05 * before:
            break
        fitted = _fit(problem, fitted.vector, fitted.information)
    found, scene = problem.split(fitted.vector)
    solved = Solved(problem, fitted, found, scene, *_parts(problem, fitted))
    _check(solved)
    return solved


def _fit(problem: Problem, vector: np.ndarray, information: np.ndarray | None) -> Fitted:
    def at(vector: np.ndarray) -> Evaluate:
        whitening = problem.whitening(vector)
        return lambda x: problem.evaluate(x, whitening)

    return robust_fit(at, vector, problem.kinds(), information)


def _bend_std(fitted: Fitted, first: int, std: float) -> float:
    """How large the bend's coefficients typically are, by the evidence (MacKay 1992): squares over the number of them
    that the points determine. Coordinates without a bend get none."""
    bend = slice(first + TERMS, first + BEFORE)
    determined = BEFORE - TERMS - float(np.trace(fitted.covariance[bend, bend])) / std**2
    size = np.sqrt(float(fitted.vector[bend] @ fitted.vector[bend]) / max(determined, 1.0))
    return float(np.clip(size, *BEND_RANGE))


def _check(solved: Solved) -> None:
    """ValueError, in one line, for views from one place, and for measured places that contradict each other or what the
    cameras see."""
    if (placed := float(solved.marker_std().max())) > PLACED_MOST:
        eyes = np.array([-rotation(pose[:3]).T @ pose[3:] for pose in solved.poses])
        apart = min(float(np.linalg.norm(one - other)) for one, other in combinations(eyes, 2))
        raise ValueError(
            f"a marker is placed to {1e3 * min(placed, 1.0):.0f} mm only; expected {1e3 * PLACED_MOST:.0f} at most: "
            f"two cameras are {apart:.2f} m apart; add a photograph from half a metre aside"
        )
    for view, rms in zip(solved.problem.views, solved.corner_rms, strict=True):
        if rms > LOST:
            raise ValueError(
                f"{view.name}: markers are {rms:.1f} px rms from where the other views have them; expected {LOST:g} at "
                "most: was one moved between photographs, or is camera.json of another camera or lens?"
            )
    for view, off, wrong in zip(solved.problem.views, solved.off, solved.wrong, strict=True):
        if wrong.mean() > MOST_WRONG:
            raise ValueError(
                f"{view.name}: {int(wrong.sum())} of its {len(wrong)} points contradict the other views, by "
                f"{1e3 * np.median(np.hypot(*off.T)):.1f} mm in the median: is it of the same table, measured alike?"
            )
    if solved.bend > BEND_MOST:
        low, high = solved.scene.bend.box
        stretch = 2.0 * float(solved.scene.bend.coefficients[TERMS_OF_BEND.index((1, 0, 1))]) / (high[1] - low[1])
        raise ValueError(
            f"measured places are up to {1e3 * solved.bend:.0f} mm from any rigid table that the cameras could see, "
            f"y {100.0 * stretch:+.1f} % long against x; expected {1e3 * BEND_MOST:.0f} mm at most: is a size of the "
            "table wrong, from whose far walls points were measured?"
        )


def _parts(problem: Problem, fitted: Fitted) -> tuple[list[np.ndarray], list[np.ndarray], list[float]]:
    """The residuals of each view: points on the table, which of them are wrong, and corners in the picture."""
    poses, scene = problem.split(fitted.vector)
    place = problem.kinds() == PLACE
    wrong = np.split(fitted.off[place] > WRONG, np.cumsum([len(view.pixels) for view in problem.views])[:-1])
    off, corner_rms = [], []
    for view, pose in zip(problem.views, poses, strict=True):
        pixels = problem.pixels(view, pose, scene)
        n = len(view.pixels)
        by_place = problem.by_place(view, pose, scene)
        off.append(np.linalg.solve(by_place, (view.pixels - pixels[:n])[:, :, None])[:, :, 0])
        corner_rms.append(float(np.sqrt(((pixels[n:] - problem.corners(view)) ** 2).sum(axis=1).mean())))
    return off, wrong, corner_rms
