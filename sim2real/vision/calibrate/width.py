"""Whether points that were measured from both side walls agree on the table's width."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.vision.calibrate.multiview import Solved
from sim2real.vision.calibrate.robust_fit import robust_fit
from sim2real.vision.scene import BEFORE
from sim2real.vision.surface import TERMS

SURE = 5.0  # standard deviations
MATTERS = 1e-3  # m


@dataclass(frozen=True)
class Step:
    """How much farther left [m] the points left of the table's middle are stated, against those right of it, than they
    are seen, and its standard deviation."""

    value: float
    std: float

    @property
    def clear(self) -> bool:
        """Whether it matters and is beyond doubt."""
        return abs(self.value) > max(MATTERS, SURE * self.std)


def step_across(solved: Solved, width: float) -> Step | None:
    """One unknown more beside cameras, markers and surface: a step of the measured y at the middle of a table of some
    width [m]. A width that is stated wrong makes one where points are measured from the nearer wall; the bend,
    which would hide it, is left out. None where one side has no points."""
    problem, vector = solved.problem, solved.fitted.vector
    y = np.concatenate([view.places[:, 1] for view in problem.views])
    if not ((y < width / 2.0).any() and (y > width / 2.0).any()):
        return None
    whitening = problem.whitening(vector)
    residuals, slope = problem.evaluate(vector, whitening)
    bend = np.arange(BEFORE - TERMS) + solved.poses.size + TERMS
    residuals = residuals - slope[:, bend] @ vector[bend]
    columns = np.column_stack([np.delete(slope, bend, axis=1), _column(solved, width, whitening, len(residuals))])
    start = np.zeros(columns.shape[1])
    fitted = robust_fit(lambda _: lambda x: (residuals + columns @ x, columns), start, problem.kinds())
    return Step(float(fitted.vector[-1]), float(np.sqrt(fitted.covariance[-1, -1])))


def _column(solved: Solved, width: float, whitening: list[np.ndarray], many: int) -> np.ndarray:
    """Derivatives (many,) of the residuals by the step."""
    found, row = np.zeros(many), 0
    for view, pose, white in zip(solved.problem.views, solved.poses, whitening, strict=True):
        n = len(view.pixels)
        side = 0.5 * np.sign(view.places[:, 1] - width / 2.0)
        by_y = (white[:n] @ solved.problem.by_place(view, pose, solved.scene))[:, :, 1]
        found[row : row + 2 * n] = (-side[:, None] * by_y).ravel()
        row += 2 * len(white)
    return found
