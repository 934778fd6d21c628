"""The opponent's mallet: a bright flat ring on top (report D). What shines round a round dark hole is the ring."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from puckpilot_env.kernel import array_kernel
from sim2real.vision.track.bright import FEWEST, Blob
from sim2real.vision.track.rim import Places, rim_of

HEIGHTS = {"standard": 0.090, "low": 0.040}  # m, of both attachments; the report has neither, so measure your own
SIZES = (0.015, 0.08)  # m, of a ring's outer radius
HOLES = (0.25, 0.85)  # of the outer radius, the hole's
ECCENTRIC = 0.15  # of the outer radius: between the middles of ring and hole
OFF = 1.5e-3  # m from a circle: farther points are others'
LEAST_ON = 0.6  # of the points of each circle
ROUNDS = 5


@dataclass(frozen=True)
class Ring:
    """A ring: its middle (2,) and its radii, outer and hole's [m]."""

    centre: np.ndarray
    radius: float
    hole: float


class RingFinder:
    """`places`: from pixels to the table at the ring's height."""

    def __init__(self, places: Places) -> None:
        self.places = places

    def find(self, image: np.ndarray, blobs: list[Blob]) -> tuple[list[Ring], list[Blob]]:
        """The rings, and what else shines: a puck may touch a ring in the picture."""
        rings, others = [], []
        for blob in blobs:
            ring = None if blob.hole is None else self._ring(image, blob.outline, blob.hole)
            if ring is None:
                others.append(blob)
                continue
            rings.append(ring)
            x, y = (self.places(blob.outline) - ring.centre).T
            rest = blob.outline[x * x + y * y > (ring.radius + 2.0 * OFF) ** 2]
            if len(rest) >= FEWEST:
                others.append(Blob(rest, None))
        return rings, others

    def _ring(self, image: np.ndarray, outline: np.ndarray, hole: np.ndarray) -> Ring | None:
        inner = _circle(rim_of(image, hole, self.places).places, None)
        if inner is None:
            return None
        outer = _circle(rim_of(image, outline, self.places).places, inner[0])
        if outer is None or not SIZES[0] <= outer[1] <= SIZES[1]:
            return None
        eccentric = float(np.linalg.norm(outer[0] - inner[0]))
        if eccentric > ECCENTRIC * outer[1] or not HOLES[0] <= inner[1] / outer[1] <= HOLES[1]:
            return None
        longer = outer[1] / (outer[1] + inner[1])  # the longer edge is the surer one
        return Ring(longer * outer[0] + (1.0 - longer) * inner[0], outer[1], inner[1])


def _circle(places: np.ndarray, middle: np.ndarray | None) -> tuple[np.ndarray, float] | None:
    """Centre (2,) and radius [m] of the circle on which most of (n, 2) points lie, or many about `middle`, if that is
    given; None if too few do."""
    if len(places) < FEWEST:
        return None
    found = np.zeros(3)
    found[:2] = places.mean(axis=0) if middle is None else middle
    count = _fit(places, found)
    if count < FEWEST or (middle is None and count < LEAST_ON * len(places)):
        return None
    return found[:2], float(found[2])


@array_kernel
def _fit(places, found):
    """Move `found` (3,), centre and radius, to where the squares of the distances from the circle of all points that
    are not too far off are least (Gauss, Newton). How many there are."""
    count = places.shape[0]
    far, off = np.empty(count), np.empty(count)
    limit, near = OFF, 0
    for turn in range(ROUNDS):
        for i in range(count):
            far[i] = max(math.hypot(places[i, 0] - found[0], places[i, 1] - found[1]), 1e-9)
        if turn == 0:
            found[2] = np.median(far)
        normal, right, near = np.zeros((3, 3)), np.zeros(3), 0
        for i in range(count):
            miss = far[i] - found[2]
            if abs(miss) >= limit:
                continue
            off[near] = abs(miss)
            near += 1
            slope = ((places[i, 0] - found[0]) / far[i], (places[i, 1] - found[1]) / far[i], 1.0)
            for a in range(3):
                right[a] += slope[a] * miss
                for b in range(3):
                    normal[a, b] += slope[a] * slope[b]
        if near < FEWEST or np.linalg.det(normal) < 1e-9:
            return 0
        found += np.linalg.solve(normal, right)
        limit = max(OFF, 2.0 * np.median(off[:near]))
    return near
