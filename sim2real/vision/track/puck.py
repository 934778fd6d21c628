"""Find the puck: a bright disc that gantry, mallet or wall may partly hide."""

from __future__ import annotations

import numpy as np

from sim2real.vision.track.blobs import Blob
from sim2real.vision.track.disc import Disc, find_disc
from sim2real.vision.track.film import Film, FilmGauge
from sim2real.vision.track.subpixel_edges import EdgePoints, Places, find_edge_points

LEAST_SEEN = (
    0.2  # least visible share of the rim; the ends of a shorter arc, at what hides it, shift the fit by millimetres
)
ENOUGH_SEEN = 0.4  # visible share of the rim at which a glint may touch the disc
LEAST_ON = 10  # least number of edge points on the rim
MOST_OUTSIDE, TOUCHED = 0.15, 0.5  # most points outside for each one on the rim, the latter where a glint may touch it


class PuckFinder:
    """Finds discs of the puck's size.

    places: maps pixels to the table at the height of the puck's top; film: of the puck, or the gauge that measures it
    from the whole discs among those that are seen.
    """

    def __init__(self, places: Places, film: Film | FilmGauge) -> None:
        self.places, self._given = places, film

    @property
    def film(self) -> Film:
        """The film as it is known at present."""
        return self._given.film if isinstance(self._given, FilmGauge) else self._given

    def find(self, image: np.ndarray, blobs: list[Blob], measure: bool = True) -> list[Disc]:
        """Find all candidates for the puck in a picture, the best first. A disc is fitted to each blob alone and to
        blobs that lie within a puck's size of each other, as the parts of a puck that a beam divides do. measure:
        whether the film may be measured by them."""
        edges = [
            edge
            for edge in (find_edge_points(image, blob.outline, self.places) for blob in blobs)
            if len(edge) >= LEAST_ON
        ]
        if measure and isinstance(self._given, FilmGauge):
            for edge in edges:
                self._given.add(edge)
        film = self.film
        found = [find_disc(EdgePoints.joined(group), film) for group in self._groups(edges)]
        good = [disc for disc in found if disc is not None and _is_puck(disc)]
        return self._apart(sorted(good, key=lambda disc: disc.outside - disc.on))

    def _apart(self, discs: list[Disc]) -> list[Disc]:
        """The discs that can exist together: of two that overlap, the better one stays."""
        kept: list[Disc] = []
        for disc in discs:
            if all(np.linalg.norm(disc.centre - other.centre) >= 2.0 * self.film.radius for other in kept):
                kept.append(disc)
        return kept

    def _groups(self, edges: list[EdgePoints]) -> list[list[EdgePoints]]:
        """Each edge alone, and each together with those near enough to belong to the same disc."""
        alone = [[edge] for edge in edges]
        if len(edges) < 2:
            return alone
        middles = [edge.places.mean(axis=0) for edge in edges]
        together = []
        for first, edge in enumerate(edges):
            near = [
                other
                for second, other in enumerate(edges)
                if second > first and np.linalg.norm(middles[second] - middles[first]) < 2.0 * self.film.radius
            ]
            if near:
                together.append([edge, *near])
        return alone + together


def _is_puck(disc: Disc) -> bool:
    most = TOUCHED if disc.seen >= ENOUGH_SEEN else MOST_OUTSIDE
    return disc.seen >= LEAST_SEEN and disc.on >= LEAST_ON and disc.outside <= most * disc.on
