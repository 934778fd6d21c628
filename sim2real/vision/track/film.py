"""The size of the puck's reflective film, measured where the whole disc is seen.

A saturated or hazy film is seen wider than it is, by as many pixels all over the picture as the light spreads. Near
and far, along and across the table a pixel is as many millimetres as the view makes it, which tells the film's radius
from this spread; a disc of which a part is hidden needs both, because its centre is found from one side alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from sim2real.vision.track.subpixel_edges import EdgePoints

RADII = (0.01, 0.05)  # m, of films that are measured
PRIOR = np.diag([0.0, 1.0])  # information: the spread is 0 within a pixel or so where no disc tells
SCATTER, LEAST_SCATTER = 0.3, 0.04  # px, limits of the scatter of a whole disc's points
ROBUST = 0.1  # px, scale of the robust loss
BINS, WHOLE = 36, 34  # sectors of the rim, and how many of them a whole disc shows
TOGETHER = 4.0  # number of neighbouring points with a common error, the factor of the variance
OWN = 0.1  # px, by which the spread of one disc differs from that of another: it is brighter, nearer, or moves
APART = 0.05  # m between discs that are measured: at one place all would err alike
ENOUGH = 40  # discs, after which the film is known
GATE = 16.0  # squared Mahalanobis distance to what is known, beyond which a disc is another one


@dataclass(frozen=True)
class Film:
    """The puck's film as it is seen.

    radius: [m]; spread: by how much it is seen wider on each side [pixels]; covariance: (2, 2) of both.
    """

    radius: float
    spread: float
    covariance: np.ndarray

    @classmethod
    def known(cls, radius: float) -> Film:
        """A film of a given radius [m], seen as wide as it is."""
        return cls(radius, 0.0, np.zeros((2, 2)))

    def edge_deviation(self, pixel: float) -> float:
        """Standard deviation [pixels] of where the rim is expected, at a place where a pixel is so wide [m]."""
        by = np.array([1.0 / pixel, 1.0])
        return float(np.sqrt(by @ self.covariance @ by))


class FilmGauge:
    """Measures the film from whole discs as they are seen, one by one.

    radius: the film's, if no whole disc has been seen yet [m].
    """

    def __init__(self, radius: float) -> None:
        self._mean, self._information = np.array([radius, 0.0]), PRIOR
        self._places: list[np.ndarray] = []
        self.film = Film(radius, 0.0, np.diag([(0.1 * radius) ** 2, 1.0]))

    @property
    def discs(self) -> int:
        """The number of discs that were measured."""
        return len(self._places)

    def add(self, edge: EdgePoints) -> None:
        """Measure the disc of which these are the edge points, if it is a whole one at a new place."""
        if self.discs >= ENOUGH:
            return
        place = edge.places.mean(axis=0)
        if any(np.linalg.norm(place - other) < APART for other in self._places):
            return
        found = measure(edge)
        if found is None:
            return
        off = np.array([found.radius, found.spread]) - self._mean
        if self.discs and off @ np.linalg.solve(found.covariance + self.film.covariance, off) > GATE:
            return
        information = np.linalg.inv(found.covariance)
        total = self._information + information
        self._mean = self._mean + np.linalg.solve(total, information @ off)
        self._information = total
        self._places.append(place)
        self.film = Film(float(self._mean[0]), float(self._mean[1]), np.linalg.inv(total))


def measure(edge: EdgePoints) -> Film | None:
    """The film's radius and spread by the edge points of one disc, with its centre free; None if they are no whole
    disc."""
    middle = edge.places.mean(axis=0)
    radius = float(np.linalg.norm(edge.places - middle, axis=1).mean())
    if not RADII[0] <= radius <= RADII[1]:
        return None

    def off(x: np.ndarray) -> np.ndarray:
        outwards = edge.places - x[:2]
        far = np.linalg.norm(outwards, axis=1)
        pixel = np.maximum((edge.steps * outwards).sum(axis=1) / far, 0.3 * np.linalg.norm(edge.steps, axis=1))
        return (far - x[2]) / pixel - x[3]

    scale = [1e-3, 1e-3, 1e-3, 1.0]
    fitted = least_squares(off, [*middle, radius, 0.0], x_scale=scale, loss="soft_l1", f_scale=ROBUST)
    scatter = 1.4826 * float(np.median(np.abs(fitted.fun)))
    outwards = (edge.places - fitted.x[:2])[np.abs(fitted.fun) < SCATTER + 2.0 * scatter]
    seen = np.unique((np.arctan2(outwards[:, 1], outwards[:, 0]) / (2.0 * np.pi) * BINS).astype(int) % BINS)
    if scatter > SCATTER or len(seen) < WHOLE or not RADII[0] <= fitted.x[2] <= RADII[1]:
        return None
    scatter = max(scatter, LEAST_SCATTER)
    covariance = TOGETHER * scatter**2 * np.linalg.inv(fitted.jac.T @ fitted.jac)[2:, 2:]
    return Film(float(fitted.x[2]), float(fitted.x[3]), covariance + np.diag([0.0, OWN**2]))
