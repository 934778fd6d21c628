"""Find the opponent's mallet: a flat bright ring with a round dark hole on its top (report D).

Fingers and the gantry's beam may hide parts of it, so its outline may be open or in pieces. Edges that face outwards
belong to the outer circle, edges that face inwards to the hole's, and both circles are concentric.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from sim2real.vision.track.blobs import FEWEST, Blob
from sim2real.vision.track.concentric_circles import OFF, fit_circles, guess_hole, shares_of_circles
from sim2real.vision.track.subpixel_edges import EdgePoints, Places, find_edge_points

HEIGHTS = {"standard": 0.090, "low": 0.040}  # m, of the two attachments; the report has neither, so measure your own
SMALLEST = 0.015  # m, least outer radius
HOLES = (0.25, 0.85)  # limits of the hole's radius as a share of the outer one
FULL = 0.8  # greatest share of its convex hull that an open piece of a ring fills
LEAST_ON = 0.6  # least share of inward-facing edges that lie on the hole's circle
LEAST_SEEN = 0.4  # least visible share of each circle
EDGE_ERROR = 0.5e-3  # m, effective standard deviation of an edge point: large, because neighbours have common errors


@dataclass(frozen=True)
class Ring:
    """A fitted ring.

    centre: (2,) [m]; covariance: (2, 2) of the centre [m^2]; radius, hole: outer radius and the hole's [m].
    """

    centre: np.ndarray
    covariance: np.ndarray
    radius: float
    hole: float


class RingFinder:
    """Finds rings. `places` maps pixels to the table at the ring's height."""

    def __init__(self, places: Places) -> None:
        self.places = places

    def find(self, image: np.ndarray, blobs: list[Blob]) -> tuple[list[Ring], list[Blob]]:
        """Find the rings in a picture. Returns them and the blobs that remain: a puck may touch a ring in the
        picture."""
        edges = [self._edge(image, blob) for blob in blobs if _is_hollow(blob)]
        rings: list[Ring] = []
        for edge in edges:
            ring = self._ring(edge, EdgePoints.joined(edges))
            if ring and all(np.linalg.norm(ring.centre - other.centre) > other.radius for other in rings):
                rings.append(ring)
        for ring in rings:
            blobs = self.beside(ring, blobs)
        return rings, blobs

    def _edge(self, image: np.ndarray, blob: Blob) -> EdgePoints:
        outline = blob.outline if blob.hole is None else np.concatenate([blob.outline, blob.hole])
        return find_edge_points(image, outline, self.places)

    def _ring(self, part: EdgePoints, whole: EdgePoints) -> Ring | None:
        """The ring that one piece of an edge suggests, fitted to all edges that can belong to it; None if there is
        none."""
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

    def beside(self, ring: Ring, blobs: list[Blob]) -> list[Blob]:
        """The parts of blobs that lie outside of a ring."""
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
