"""Where on the table places are known worst, and how far the nearest measured point is."""

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
    """The place that is known worst on a table of some length and width [m]; what the bend may do beyond all points is
    not counted."""
    x, y = np.meshgrid(np.linspace(0.0, length, ALONG), np.linspace(0.0, width, ACROSS))
    places = np.stack([x.ravel(), y.ravel()], axis=1)
    grid = View("grid", {}, np.zeros_like(places), places)
    problem, covariance = solved.problem, solved.fitted.covariance
    variance = np.zeros(len(places))
    for k, pose in enumerate(solved.poses):
        _, by = problem.of_view(grid, pose, solved.scene, 6 * k, len(covariance))
        by = np.linalg.solve(problem.by_place(grid, pose, solved.scene), by)
        variance += np.einsum("nij,jk,nik->n", by, covariance, by, optimize=True) / len(solved.poses)
    measured = np.concatenate([view.places for view in problem.views])
    worst = int(np.argmax(variance))
    away = float(np.hypot(*(measured - places[worst]).T).min())
    return Weakest(places[worst], float(np.sqrt(variance[worst])), away)
