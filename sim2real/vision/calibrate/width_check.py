"""A check of the stated table width: do points that were measured from either side wall agree?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.vision.calibrate.multiview import MultiviewFit
from sim2real.vision.calibrate.robust_fit import robust_fit
from sim2real.vision.surface import TERMS
from sim2real.vision.table_geometry import MARKERS_START

SURE = 5.0  # standard deviations of a significant step
MATTERS = 1e-3  # m, least step that matters


@dataclass(frozen=True)
class WidthStep:
    """The step of measured y coordinates at the table's middle.

    value: how much farther to the left the points left of the middle are stated, relative to those right of it, than
    they are seen [m]; std: its standard deviation [m].
    """

    value: float
    std: float

    @property
    def clear(self) -> bool:
        """Whether the step is large enough to matter and statistically significant."""
        return abs(self.value) > max(MATTERS, SURE * self.std)


def width_step(fit: MultiviewFit, width: float) -> WidthStep | None:
    """Estimate a step of the measured y at the middle of a table of this width [m], as one more unknown beside cameras,
    markers and surface.

    If points are measured from the nearer side wall, an error of the stated width makes such a step. The warp would
    absorb it and is therefore left out. None if one half of the table has no points.
    """
    problem, vector = fit.problem, fit.fitted.vector
    y = np.concatenate([view.places[:, 1] for view in problem.views])
    if not ((y < width / 2.0).any() and (y > width / 2.0).any()):
        return None
    whitening = problem.whitening(vector)
    residuals, slope = problem.evaluate(vector, whitening)
    warp = np.arange(MARKERS_START - TERMS) + fit.poses.size + TERMS
    residuals = residuals - slope[:, warp] @ vector[warp]
    columns = np.column_stack([np.delete(slope, warp, axis=1), _column(fit, width, whitening, len(residuals))])
    start = np.zeros(columns.shape[1])
    fitted = robust_fit(lambda _: lambda x: (residuals + columns @ x, columns), start, problem.kinds())
    return WidthStep(float(fitted.vector[-1]), float(np.sqrt(fitted.covariance[-1, -1])))


def _column(fit: MultiviewFit, width: float, whitening: list[np.ndarray], many: int) -> np.ndarray:
    """Derivatives (many,) of the residuals by the step [1/m]."""
    found, row = np.zeros(many), 0
    for view, pose, white in zip(fit.problem.views, fit.poses, whitening, strict=True):
        n = len(view.pixels)
        side = 0.5 * np.sign(view.places[:, 1] - width / 2.0)
        by_y = (white[:n] @ fit.problem.by_place(view, pose, fit.geometry))[:, :, 1]
        found[row : row + 2 * n] = (-side[:, None] * by_y).ravel()
        row += 2 * len(white)
    return found
