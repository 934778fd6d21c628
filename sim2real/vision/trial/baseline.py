"""Baselines for the puck's centre: the report's rules for a puck that may be partly hidden (C.2), and the centroid."""

from __future__ import annotations

import numpy as np

STRIP = 1.2e-3  # m, width of the strips at the lowest and the highest x (eq. 20, 21)
ON = 2.5e-3  # m, greatest distance of a point that lies on the circle (eq. 24)
SAME = 2e-3  # m, greatest distance between the candidates of a puck that is not hidden
CLEARLY = 1.5  # ratio of points by which one candidate is better than the other (eq. 25)


def centroid(contour: np.ndarray) -> np.ndarray:
    """The mean (2,) of a contour (n, 2) on the table [m]."""
    return contour.mean(axis=0)


def report_centre(contour: np.ndarray, radius: float, before: np.ndarray) -> np.ndarray:
    """The centre (2,) [m] of a puck by the report's rules.

    contour: (n, 2) on the table [m]; radius: of the puck [m]; before: (2,) its centre in the last picture [m].
    """
    x = contour[:, 0]
    step = np.array([radius, 0.0])
    low, high = contour[x < x.min() + STRIP].mean(axis=0) + step, contour[x > x.max() - STRIP].mean(axis=0) - step
    if np.linalg.norm(low - high) < SAME:
        return centroid(contour)
    both = np.array([low, high])
    points = [(np.abs(np.linalg.norm(contour - one, axis=1) - radius) < ON).sum() for one in both]
    if max(points) > CLEARLY * min(points):
        return both[np.argmax(points)]
    return both[np.argmin(np.linalg.norm(both - before, axis=1))]
