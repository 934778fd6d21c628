"""What is the same in every view, as a vector of parameters: surface, coordinate warp and marker corners."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.vision import coordinate_warp, surface
from sim2real.vision.coordinate_warp import CoordinateWarp
from sim2real.vision.surface import Surface

MARKERS_START = surface.TERMS + len(coordinate_warp.TERMS)  # parameters of surface and warp, before the markers'
PER_MARKER = 12  # parameters: three for each corner


@dataclass(frozen=True)
class TableGeometry:
    """Surface, coordinate warp, and markers by id: corners (4, 3) [m] in the rigid frame, clockwise from the marker's
    own top left.

    Each corner has parameters of its own: a printed marker is neither quite flat nor quite square, which is visible at
    0.05 px.
    """

    surface: Surface
    warp: CoordinateWarp
    markers: dict[int, np.ndarray]

    def vector(self) -> np.ndarray:
        """All parameters in one vector (parameters,): curvature, warp coefficients, then the markers in order."""
        return np.concatenate([self.surface.curvature, self.warp.coefficients, *map(np.ravel, self.markers.values())])

    def replaced(self, vector: np.ndarray) -> TableGeometry:
        """The geometry with other parameters (parameters,), in the order of `vector`."""
        xx, xy, yy = (float(one) for one in vector[: surface.TERMS])
        rows = vector[MARKERS_START:].reshape(-1, 4, 3)
        return TableGeometry(
            Surface(self.surface.middle, (xx, xy, yy)),
            CoordinateWarp(self.warp.box, vector[surface.TERMS : MARKERS_START]),
            dict(zip(self.markers, rows, strict=True)),
        )

    def column(self, marker: int) -> int:
        """The index in the vector at which the parameters of a marker begin."""
        return MARKERS_START + PER_MARKER * list(self.markers).index(marker)

    def points(self, places: np.ndarray, height: float) -> np.ndarray:
        """Points (n, 3) [m] of the rigid frame at a height [m] above measured places (n, 2) [m]."""
        flat = self.warp.rigid(places)
        return np.column_stack([flat, self.surface.height(flat) + height])

    def points_by(self, places: np.ndarray) -> np.ndarray:
        """Derivatives (n, 3, MARKERS_START) of `points` at places (n, 2) [m] by curvature and warp coefficients."""
        flat = self.warp.rigid(places)
        terms, slope = self.warp.terms(places), self.surface.slope(flat)
        by = np.zeros((len(places), 3, MARKERS_START))
        by[:, 2, : surface.TERMS] = self.surface.terms(flat)
        by[:, :2, surface.TERMS :] = -terms
        by[:, 2, surface.TERMS :] = -np.einsum("ni,nik->nk", slope, terms)
        return by
