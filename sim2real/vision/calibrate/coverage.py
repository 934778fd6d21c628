"""How well places all over the table are known: typically, and where they are known worst."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.vision.calibrate.multiview import Solved
from sim2real.vision.calibrate.view import View

ALONG, ACROSS = 13, 7  # places of the table that are looked at
SURE = 2e-3  # m, that places everywhere should be known to


@dataclass(frozen=True)
class Weakest:
    """A `place` (2,) [m] of the table, the standard deviation [m] to which the calibration's own cameras find it, and
    how far `away` [m] the nearest measured point is."""

    place: np.ndarray
    std: float
    away: float

    @property
    def matters(self) -> bool:
        """Whether points are missing there."""
        return self.std > SURE


def weakest(solved: Solved, length: float, width: float) -> Weakest:
    """The place that is known worst on a table of some length and width [m]."""
    places, variances = _variances(solved, length, width)
    measured = np.concatenate([view.places for view in solved.problem.views])
    worst = int(np.argmax(variances))
    away = float(np.hypot(*(measured - places[worst]).T).min())
    return Weakest(places[worst], float(np.sqrt(variances[worst])), away)


def place_std(solved: Solved, length: float, width: float) -> float:
    """How far places are typically off along each axis [m], root mean square over the table."""
    return float(np.sqrt(0.5 * _variances(solved, length, width)[1].mean()))


def _variances(solved: Solved, length: float, width: float) -> tuple[np.ndarray, np.ndarray]:
    """Places (n, 2) [m] all over the table, and how far off they are found, squared (n,) [m^2]; what the bend may do
    beyond all points is not counted."""
    x, y = np.meshgrid(np.linspace(0.0, length, ALONG), np.linspace(0.0, width, ACROSS))
    places = np.stack([x.ravel(), y.ravel()], axis=1)
    grid = View("grid", {}, np.zeros_like(places), places)
    problem, covariance = solved.problem, solved.fitted.covariance
    variances = np.zeros(len(places))
    for k, pose in enumerate(solved.poses):
        _, by = problem.of_view(grid, pose, solved.scene, 6 * k, len(covariance))
        by = np.linalg.solve(problem.by_place(grid, pose, solved.scene), by)
        variances += np.einsum("nij,jk,nik->n", by, covariance, by, optimize=True) / len(solved.poses)
    return places, variances
