"""The standard deviations of places all over the table: the typical one and the greatest one."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sim2real.vision.calibrate.calibration_view import CalibrationView
from sim2real.vision.calibrate.multiview import MultiviewFit
from sim2real.vision.locate import Locator

ALONG, ACROSS = 13, 7  # places of the evaluation grid
SURE = 2e-3  # m, greatest standard deviation of a calibration that covers the table


@dataclass(frozen=True)
class WorstKnownPlace:
    """The place with the greatest uncertainty.

    place: (2,) [m]; std: standard deviation of places found there by the calibration's own cameras [m]; away: distance
    to the nearest measured point [m].
    """

    place: np.ndarray
    std: float
    away: float

    @property
    def matters(self) -> bool:
        """Whether the place is so uncertain that points should be measured there."""
        return self.std > SURE


def worst_known_place(fit: MultiviewFit, length: float, width: float) -> WorstKnownPlace:
    """Find the place with the greatest uncertainty on a table of this length and width [m]."""
    places, variances = _variances(fit, length, width)
    measured = np.concatenate([view.places for view in fit.problem.views])
    worst = int(np.argmax(variances))
    away = float(np.hypot(*(measured - places[worst]).T).min())
    return WorstKnownPlace(places[worst], float(np.sqrt(variances[worst])), away)


def place_std(fit: MultiviewFit, length: float, width: float) -> float:
    """The typical error of places along each axis [m]: root mean square over a table of this length and width [m]."""
    return float(np.sqrt(0.5 * _variances(fit, length, width)[1].mean()))


def pose_place_std(locator: Locator, covariance: np.ndarray, length: float, width: float) -> float:
    """The typical error of places along each axis [m] that the camera's pose has, by the covariance (6, 6) of its
    motion: root mean square over a table of this length and width [m]."""
    x, y = np.meshgrid(np.linspace(0.0, length, ALONG), np.linspace(0.0, width, ACROSS))
    pixels = locator.pixels(np.stack([x.ravel(), y.ravel()], axis=1), 0.0)
    here = locator.places(pixels, 0.0)
    values, vectors = np.linalg.eigh(covariance)
    moves = (vectors * np.sqrt(np.maximum(values, 0.0))).T
    off = [replace(locator, motion=locator.motion + one).places(pixels, 0.0) - here for one in moves]
    return float(np.sqrt(0.5 * np.nanmean((np.array(off) ** 2).sum(axis=(0, 2)))))


def _variances(fit: MultiviewFit, length: float, width: float) -> tuple[np.ndarray, np.ndarray]:
    """Places (n, 2) [m] on a grid over the table, and the variances (n,) [m^2] with which the views' cameras find them,
    averaged over the cameras. Beyond all measured points the warp is constant, so its error there is not counted."""
    x, y = np.meshgrid(np.linspace(0.0, length, ALONG), np.linspace(0.0, width, ACROSS))
    places = np.stack([x.ravel(), y.ravel()], axis=1)
    grid = CalibrationView("grid", {}, np.zeros_like(places), places)
    problem, covariance = fit.problem, fit.fitted.covariance
    variances = np.zeros(len(places))
    for k, pose in enumerate(fit.poses):
        _, by = problem.of_view(grid, pose, fit.geometry, 6 * k, len(covariance))
        by = np.linalg.solve(problem.by_place(grid, pose, fit.geometry), by)
        variances += np.einsum("nij,jk,nik->n", by, covariance, by, optimize=True) / len(fit.poses)
    return places, variances
