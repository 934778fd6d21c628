"""What is the same in every view: the marker's places, surface and bend, as a vector of numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.vision import bend, surface
from sim2real.vision.bend import Bend
from sim2real.vision.surface import Surface

BEFORE = surface.TERMS + len(bend.TERMS)  # numbers of a scene before those of the markers
EACH = 12  # numbers of a marker: three for each corner


@dataclass(frozen=True)
class Scene:
    """Surface, bend and markers: id -> corners (4, 3) [m], as they are detected: clockwise from the marker's top left.

    The corners are free: a printed marker is neither quite flat nor quite square, which at 0.05 px shows."""

    surface: Surface
    bend: Bend
    markers: dict[int, np.ndarray]

    def vector(self) -> np.ndarray:
        """All numbers in one vector: curvature, bend, then the markers in order."""
        return np.concatenate([self.surface.curvature, self.bend.coefficients, *map(np.ravel, self.markers.values())])

    def replaced(self, vector: np.ndarray) -> Scene:
        """The scene with other numbers."""
        xx, xy, yy = (float(one) for one in vector[: surface.TERMS])
        rows = vector[BEFORE:].reshape(-1, 4, 3)
        return Scene(
            Surface(self.surface.middle, (xx, xy, yy)),
            Bend(self.bend.box, vector[surface.TERMS : BEFORE]),
            dict(zip(self.markers, rows, strict=True)),
        )

    def column(self, marker: int) -> int:
        """Where the numbers of a marker begin in the vector."""
        return BEFORE + EACH * list(self.markers).index(marker)

    def points(self, places: np.ndarray, height: float) -> np.ndarray:
        """Where (n, 3) things are that stand at measured places (n, 2) with their marks at a height [m]."""
        flat = self.bend.rigid(places)
        return np.column_stack([flat, self.surface.height(flat) + height])

    def points_by(self, places: np.ndarray) -> np.ndarray:
        """Derivatives (n, 3, BEFORE) of `points` by curvature and bend."""
        flat = self.bend.rigid(places)
        terms, slope = self.bend.terms(places), self.surface.slope(flat)
        by = np.zeros((len(places), 3, BEFORE))
        by[:, 2, : surface.TERMS] = self.surface.terms(flat)
        by[:, :2, surface.TERMS :] = -terms
        by[:, 2, surface.TERMS :] = -np.einsum("ni,nik->nk", slope, terms)
        return by
