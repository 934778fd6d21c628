"""The report's multi-view procedure (B.4), a bundle adjustment: camera poses, markers, surface and coordinate warp from
several views at once."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from sim2real.vision.calibrate.calibration_view import CalibrationView
from sim2real.vision.calibrate.initial_guess import initial_guess
from sim2real.vision.calibrate.pose import LOST
from sim2real.vision.calibrate.residuals import PLACE, MultiviewResiduals
from sim2real.vision.calibrate.robust_fit import Evaluate, RobustFit, robust_fit
from sim2real.vision.camera_file import Setup
from sim2real.vision.coordinate_warp import TERMS as TERMS_OF_WARP
from sim2real.vision.markers import FEWEST
from sim2real.vision.motion import rotation
from sim2real.vision.surface import TERMS
from sim2real.vision.table_geometry import MARKERS_START, TableGeometry

FEWEST_VIEWS = 2
WARP_STD = 1e-3  # m, prior standard deviation of the warp's coefficients at the first fit,
WARP_RANGE = (3e-5, 3e-3)  # and its limits when it is estimated
ROUNDS = 8  # of that estimate
WARP_MOST = 6e-3  # m: faults of rulers and walls are smaller
# m, the standard deviation of a marker: 23 mm by two real photographs whose cameras were 6 cm apart; at 40 mm places in
# a third are 3 mm off on average, 7 mm at most
PLACED_MOST = 0.04
MOST_WRONG = 1.0 / 3.0  # share of a view's points that may be outliers
OUTLIER = 3.5  # standard deviations: of 108 good points, 0.4 lie farther off by chance


@dataclass(frozen=True)
class MultiviewFit:
    """The result of the joint fit.

    problem: the residuals that were fitted; fitted: the solution and its covariance; poses: (views, 6), from the
    table's rigid frame to each camera's; geometry: of the table; off: for each view (n, 2) [m], seen minus stated
    places on the table; wrong: for each view (n,), whether a point is an outlier; corner_rms: for each view the root
    mean square residual of the markers' corners [pixels].
    """

    problem: MultiviewResiduals
    fitted: RobustFit
    poses: np.ndarray
    geometry: TableGeometry
    off: list[np.ndarray]
    wrong: list[np.ndarray]
    corner_rms: list[float]

    @property
    def warp(self) -> float:
        """The greatest displacement [m] of the coordinate warp at a measured place."""
        places = np.concatenate([view.places for view in self.problem.views])
        return float(np.hypot(*(places - self.geometry.warp.rigid(places)).T).max())

    def geometry_covariance(self) -> np.ndarray:
        """Covariance (parameters, parameters) of the geometry's vector."""
        many = self.poses.size
        return self.fitted.covariance[many:, many:]

    def marker_std(self) -> np.ndarray:
        """Standard deviations (markers, 4, 3) [m] of the markers' corners."""
        std = self.geometry.replaced(np.sqrt(np.diag(self.geometry_covariance())))
        return np.array(list(std.markers.values()))


def solve(setup: Setup, views: tuple[CalibrationView, ...]) -> MultiviewFit:
    """Fit poses, markers, surface and warp to all views at once.

    The prior of the warp is re-estimated from the evidence between fits. Raises ValueError, in one line, if the views
    are too few or contradict each other.
    """
    if len(views) < FEWEST_VIEWS:
        raise ValueError(f"{len(views)} view is given; expected {FEWEST_VIEWS} at least, better 3 from apart")
    poses, geometry = initial_guess(setup.camera, views, setup.puck_top, (setup.length / 2.0, setup.width / 2.0))
    if len(geometry.markers) < FEWEST:
        raise ValueError(f"{len(geometry.markers)} markers are seen in two views or more; expected {FEWEST} at least")
    problem = MultiviewResiduals(setup.camera, views, geometry, setup.puck_top, WARP_STD)
    vector = np.concatenate([poses.ravel(), geometry.vector()])
    fitted = _fit(problem, vector, None)
    for _ in range(ROUNDS):
        before = problem.warp_std
        problem = replace(problem, warp_std=_warp_std(fitted, poses.size, before))
        if abs(problem.warp_std - before) < 0.05 * before:
            break
        fitted = _fit(problem, fitted.vector, fitted.information)
    found, geometry = problem.split(fitted.vector)
    fit = MultiviewFit(problem, fitted, found, geometry, *_parts(problem, fitted))
    _check(fit)
    return fit


def _fit(problem: MultiviewResiduals, vector: np.ndarray, information: np.ndarray | None) -> RobustFit:
    def at(vector: np.ndarray) -> Evaluate:
        whitening = problem.whitening(vector)
        return lambda x: problem.evaluate(x, whitening)

    return robust_fit(at, vector, problem.kinds(), information)


def _warp_std(fitted: RobustFit, first: int, std: float) -> float:
    """The prior standard deviation [m] of the warp's coefficients, by evidence maximization (MacKay 1992): their sum of
    squares divided by the number of coefficients that the points determine. `first`: index of the geometry in the
    vector; `std`: the prior of the fit."""
    warp = slice(first + TERMS, first + MARKERS_START)
    determined = MARKERS_START - TERMS - float(np.trace(fitted.covariance[warp, warp])) / std**2
    size = np.sqrt(float(fitted.vector[warp] @ fitted.vector[warp]) / max(determined, 1.0))
    return float(np.clip(size, *WARP_RANGE))


def _check(fit: MultiviewFit) -> None:
    """Raise ValueError, in one line, for views that are too close together to triangulate, and for views or measured
    places that contradict each other."""
    if (placed := float(fit.marker_std().max())) > PLACED_MOST:
        origins = np.array([-rotation(pose[:3]).T @ pose[3:] for pose in fit.poses])
        apart = min(float(np.linalg.norm(one - other)) for one, other in combinations(origins, 2))
        raise ValueError(
            f"a marker is placed to {1e3 * min(placed, 1.0):.0f} mm only; expected {1e3 * PLACED_MOST:.0f} at most: "
            f"two cameras are {apart:.2f} m apart; add a photograph from half a metre aside"
        )
    for view, rms in zip(fit.problem.views, fit.corner_rms, strict=True):
        if rms > LOST:
            raise ValueError(
                f"{view.name}: markers are {rms:.1f} px rms from where the other views have them; expected {LOST:g} at "
                "most: was one moved between photographs, or is camera.json of another camera or lens?"
            )
    for view, off, wrong in zip(fit.problem.views, fit.off, fit.wrong, strict=True):
        if wrong.mean() > MOST_WRONG:
            raise ValueError(
                f"{view.name}: {int(wrong.sum())} of its {len(wrong)} points contradict the other views, by "
                f"{1e3 * np.median(np.hypot(*off.T)):.1f} mm in the median: is it of the same table, measured alike?"
            )
    if fit.warp > WARP_MOST:
        low, high = fit.geometry.warp.box
        stretch = 2.0 * float(fit.geometry.warp.coefficients[TERMS_OF_WARP.index((1, 0, 1))]) / (high[1] - low[1])
        raise ValueError(
            f"measured places are up to {1e3 * fit.warp:.0f} mm from any rigid table that the cameras could see, "
            f"y {100.0 * stretch:+.1f} % long against x; expected {1e3 * WARP_MOST:.0f} mm at most: is a size of the "
            "table wrong, from whose far walls points were measured?"
        )


def _parts(problem: MultiviewResiduals, fitted: RobustFit) -> tuple[list[np.ndarray], list[np.ndarray], list[float]]:
    """The residuals of each view: points on the table (n, 2) [m], which of them (n,) are outliers, and the root mean
    square of the corners [pixels]."""
    poses, geometry = problem.split(fitted.vector)
    place = problem.kinds() == PLACE
    wrong = np.split(fitted.off[place] > OUTLIER, np.cumsum([len(view.pixels) for view in problem.views])[:-1])
    off, corner_rms = [], []
    for view, pose in zip(problem.views, poses, strict=True):
        pixels = problem.pixels(view, pose, geometry)
        n = len(view.pixels)
        by_place = problem.by_place(view, pose, geometry)
        off.append(np.linalg.solve(by_place, (view.pixels - pixels[:n])[:, :, None])[:, :, 0])
        corner_rms.append(float(np.sqrt(((pixels[n:] - problem.corners(view)) ** 2).sum(axis=1).mean())))
    return off, wrong, corner_rms
