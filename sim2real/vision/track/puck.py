"""The puck: a bright disc, of which a gantry, a mallet or a wall may hide some."""

from __future__ import annotations

import numpy as np

from sim2real.vision.track.bright import Blob
from sim2real.vision.track.disc import Disc, find_disc
from sim2real.vision.track.rim import Places, Rim, rim_of

LEAST_SEEN = 0.2  # of the rim; with less an arc's ends, where what hides the disc begins, pull it off by millimetres
ENOUGH_SEEN = 0.4  # with so much of it, a glint may touch it,
LEAST_ON = 10  # edge points
MOST_OUTSIDE, TOUCHED = 0.15, 0.5  # points outside for each one on the rim, at most, and where a glint touches it


class PuckFinder:
    """`places`: from pixels to the table at the height of the puck's top; `radius` [m]."""

    def __init__(self, places: Places, radius: float) -> None:
        self.places, self.radius = places, radius

    def find(self, image: np.ndarray, blobs: list[Blob]) -> list[Disc]:
        """All that may be the puck, the best first: discs of single blobs, and of several within a puck's size of each
        other, as those of one that a beam divides."""
        rims = [rim for rim in (rim_of(image, blob.outline, self.places) for blob in blobs) if len(rim) >= LEAST_ON]
        found = [find_disc(Rim.joined(group), self.radius) for group in self._groups(rims)]
        good = [disc for disc in found if disc is not None and _is_puck(disc)]
        return self._apart(sorted(good, key=lambda disc: disc.outside - disc.on))

    def _apart(self, discs: list[Disc]) -> list[Disc]:
        """Those that can be there at once: of two that overlap, the former."""
        kept: list[Disc] = []
        for disc in discs:
            if all(np.linalg.norm(disc.centre - other.centre) >= 2.0 * self.radius for other in kept):
                kept.append(disc)
        return kept

    def _groups(self, rims: list[Rim]) -> list[list[Rim]]:
        """Each rim alone, and with all that lie so near that one disc can have both."""
        alone = [[rim] for rim in rims]
        if len(rims) < 2:
            return alone
        middles = [rim.places.mean(axis=0) for rim in rims]
        together = []
        for first, rim in enumerate(rims):
            near = [
                other
                for second, other in enumerate(rims)
                if second > first and np.linalg.norm(middles[second] - middles[first]) < 2.0 * self.radius
            ]
            if near:
                together.append([rim, *near])
        return alone + together


def _is_puck(disc: Disc) -> bool:
    most = TOUCHED if disc.seen >= ENOUGH_SEEN else MOST_OUTSIDE
    return disc.seen >= LEAST_SEEN and disc.on >= LEAST_ON and disc.outside <= most * disc.on
