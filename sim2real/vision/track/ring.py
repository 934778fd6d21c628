"""The opponent's mallet: a bright flat ring on top (report D). What shines round a round dark hole is the ring.

Fingers and the gantry's beam may hide some of it, so that its outline is open or in parts: what faces outwards of its
edges lies on the outer circle, what faces inwards on the hole's, round the same middle.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from sim2real.vision.track.bright import FEWEST, Blob
from sim2real.vision.track.circles import OFF, fit_circles, guess_hole, shares_of_circles
from sim2real.vision.track.rim import Places, Rim, rim_of

HEIGHTS = {"standard": 0.090, "low": 0.040}  # m, of both attachments; the report has neither, so measure your own
SMALLEST = 0.015  # m, of a ring's outer radius
HOLES = (0.25, 0.85)  # of the outer radius, the hole's
FULL = 0.8  # of its hull: what shines in more of it is no part of a ring
LEAST_ON = 0.6  # of the edges that face inwards: on the hole's circle
LEAST_SEEN = 0.4  # of each circle
EDGE_ERROR = 0.5e-3  # m, standard deviation of an edge point, if they erred apart: neighbours err as one


@dataclass(frozen=True)
class Ring:
    """A ring: its middle (2,) [m], the middle's covariance (2, 2) [m^2], and its radii, outer and hole's [m]."""

    centre: np.ndarray
    covariance: np.ndarray
    radius: float
    hole: float


class RingFinder:
    """`places`: from pixels to the table at the ring's height."""

    def __init__(self, places: Places) -> None:
        self.places = places

    def find(self, image: np.ndarray, blobs: list[Blob]) -> tuple[list[Ring], list[Blob]]:
        """The rings, and what else shines: a puck may touch a ring in the picture."""
        rims = [self._rim(image, blob) for blob in blobs if _is_hollow(blob)]
        rings: list[Ring] = []
        for rim in rims:
            ring = self._ring(rim, Rim.joined(rims))
            if ring and all(np.linalg.norm(ring.centre - other.centre) > other.radius for other in rings):
                rings.append(ring)
        for ring in rings:
            blobs = self._beside(ring, blobs)
        return rings, blobs

    def _rim(self, image: np.ndarray, blob: Blob) -> Rim:
        outline = blob.outline if blob.hole is None else np.concatenate([blob.outline, blob.hole])
        return rim_of(image, outline, self.places)

    def _ring(self, part: Rim, whole: Rim) -> Ring | None:
        """The ring of which some is seen in a part, by all that can be of it."""
        found = np.zeros(4)
        if len(part) < FEWEST or not guess_hole(part.places, part.steps, found):
            return None
        covariance = np.zeros((2, 2))
        if not fit_circles(whole.places, whole.steps, found, covariance):
            return None
        radius, hole = float(found[2]), float(found[3])
        if radius < SMALLEST or not HOLES[0] <= hole / radius <= HOLES[1]:
            return None
        *seen, on = shares_of_circles(whole.places, whole.steps, found)
        if min(seen) < LEAST_SEEN or on < LEAST_ON:
            return None
        return Ring(found[:2], EDGE_ERROR**2 * covariance, radius, hole)

    def _beside(self, ring: Ring, blobs: list[Blob]) -> list[Blob]:
        """What is left of blobs outside of a ring."""
        left = []
        for blob in blobs:
            x, y = (self.places(blob.outline) - ring.centre).T
            rest = blob.outline[x * x + y * y > (ring.radius + 2.0 * OFF) ** 2]
            if len(rest) == len(blob.outline):
                left.append(blob)
            elif len(rest) >= FEWEST:
                left.append(Blob(rest, None))
        return left


def _is_hollow(blob: Blob) -> bool:
    return blob.hole is not None or cv2.contourArea(blob.outline) < FULL * cv2.contourArea(cv2.convexHull(blob.outline))
