"""The report's rules for a puck that may be partly hidden (C.2), and the plain centroid: the disc's rivals."""

from __future__ import annotations

import numpy as np

STRIP = 1.2e-3  # m from the lowest and highest x (eq. 20, 21)
ON = 2.5e-3  # m from the circle (eq. 24)
SAME = 2e-3  # m between the candidates of a puck that is not hidden,
CLEARLY = 1.5  # and how many times more points the better of two has (eq. 25)


def centroid(contour: np.ndarray) -> np.ndarray:
    """The mean (2,) of a contour (n, 2) on the table [m]."""
    return contour.mean(axis=0)


def report_centre(contour: np.ndarray, radius: float, before: np.ndarray) -> np.ndarray:
    """Centre (2,) [m] of a puck of this radius whose contour (n, 2) is on the table, and that was at `before` (2,) in
    the last picture."""
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
