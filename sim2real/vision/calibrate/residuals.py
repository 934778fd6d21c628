"""The residuals of the bundle adjustment, in standard deviations, with analytic derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.vision.calibrate.calibration_view import CalibrationView
from sim2real.vision.camera import CameraModel
from sim2real.vision.motion import apply_motion
from sim2real.vision.surface import TERMS
from sim2real.vision.table_geometry import MARKERS_START, TableGeometry

# least standard deviations: smaller residuals are chance, or errors common to all views; `robust_fit` scales them up
CORNER_STD = 0.05  # px, of a marker's corner by `edges`
PIXEL_STD = 0.2  # px, of the puck's centre
PLACE_STD = 0.5e-3  # m, of a place measured by hand
PLACE, CORNER = 0, 1  # kinds of residual pairs
CURVATURE_STD = 0.02  # 1/m, prior of the curvature: 2 cm at 1 m from the middle, more than any playable table


@dataclass(frozen=True)
class MultiviewResiduals:
    """The residuals of all views, a function of one vector of unknowns: six numbers for the camera of each view, then
    the geometry's parameters.

    geometry: the initial one, which says what markers there are; height: of the puck's mark above the surface [m];
    warp_std: prior standard deviation of each coefficient of the warp [m].
    """

    camera: CameraModel
    views: tuple[CalibrationView, ...]
    geometry: TableGeometry
    height: float
    warp_std: float

    def split(self, vector: np.ndarray) -> tuple[np.ndarray, TableGeometry]:
        """Split a vector of unknowns into the cameras' poses (views, 6) and the geometry."""
        many = 6 * len(self.views)
        return vector[:many].reshape(-1, 6), self.geometry.replaced(vector[many:])

    def kinds(self) -> np.ndarray:
        """The kind (pairs,), PLACE or CORNER, of each pair of residuals in the order of `evaluate`."""
        return np.concatenate(
            [np.repeat([PLACE, CORNER], [len(view.pixels), len(self.corners(view))]) for view in self.views]
        )

    def evaluate(self, vector: np.ndarray, whitening: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Residuals (m,) in standard deviations and their derivatives (m, unknowns): for each view the measured points,
        then the corners, each pair multiplied by its matrix of `whitening`; in the end the priors of curvature and
        warp."""
        poses, geometry = self.split(vector)
        rows, slopes = [], []
        for k, (view, pose) in enumerate(zip(self.views, poses, strict=True)):
            off, by = self.of_view(view, pose, geometry, 6 * k, len(vector))
            rows.append(np.einsum("nij,nj->ni", whitening[k], off).ravel())
            slopes.append((whitening[k] @ by).reshape(-1, len(vector)))
        first = 6 * len(self.views)
        std = np.r_[np.full(TERMS, CURVATURE_STD), np.full(MARKERS_START - TERMS, self.warp_std)]
        prior = np.zeros((MARKERS_START, len(vector)))
        prior[:, first : first + MARKERS_START] = np.diag(1.0 / std)
        return np.concatenate([*rows, vector[first : first + MARKERS_START] / std]), np.concatenate([*slopes, prior])

    def whitening(self, vector: np.ndarray) -> list[np.ndarray]:
        """For each view the matrices (points + corners, 2, 2) that turn residuals in pixels into standard deviations: a
        hand-measured place is uncertain on the table, a corner in the picture."""
        poses, geometry = self.split(vector)
        found = []
        for view, pose in zip(self.views, poses, strict=True):
            by_place = self.by_place(view, pose, geometry)
            spread = PLACE_STD**2 * by_place @ by_place.transpose(0, 2, 1) + PIXEL_STD**2 * np.eye(2)
            corners = np.broadcast_to(np.eye(2) / CORNER_STD, (4 * len(self._shared(view)), 2, 2))
            found.append(np.concatenate([np.linalg.inv(np.linalg.cholesky(spread)), corners]))
        return found

    def by_place(self, view: CalibrationView, pose: np.ndarray, geometry: TableGeometry) -> np.ndarray:
        """Derivatives (n, 2, 2) [pixels/m] of the pixels of a view's measured points by their places."""
        points = geometry.points(view.places, self.height)
        seen, _, turn = apply_motion(pose, points)
        slope = geometry.surface.slope(points[:, :2])
        by = self.camera.project(seen)[1] @ turn
        return by[:, :, :2] + by[:, :, 2:] * slope[:, None, :]

    def pixels(self, view: CalibrationView, pose: np.ndarray, geometry: TableGeometry) -> np.ndarray:
        """Projected pixels (n, 2) of a view's measured points, then of its corners."""
        corners = [geometry.markers[marker] for marker in self._shared(view)]
        points = np.concatenate([geometry.points(view.places, self.height), *corners])
        return self.camera.project(apply_motion(pose, points)[0])[0]

    def corners(self, view: CalibrationView) -> np.ndarray:
        """Detected corners (n, 2) [pixels] of a view's markers that are in the geometry."""
        return np.array([view.corners[marker] for marker in self._shared(view)]).reshape(-1, 2)

    def _shared(self, view: CalibrationView) -> list[int]:
        return [marker for marker in self.geometry.markers if marker in view.corners]

    def of_view(
        self, view: CalibrationView, pose: np.ndarray, geometry: TableGeometry, column: int, many: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """Residuals of a view, projected minus detected pixels (n, 2), with derivatives (n, 2, unknowns).

        column: of the first unknown of the pose; many: number of unknowns.
        """
        markers = self._shared(view)
        points = geometry.points(view.places, self.height)
        seen, by_pose, turn = apply_motion(
            pose, np.concatenate([points, *(geometry.markers[marker] for marker in markers)])
        )
        pixels, by_seen = self.camera.project(seen)
        by = np.zeros((len(pixels), 2, many))
        by[:, :, column : column + 6] = by_seen @ by_pose
        first, n = 6 * len(self.views), len(points)
        by[:n, :, first : first + MARKERS_START] = by_seen[:n] @ turn @ geometry.points_by(view.places)
        by_point = by_seen[n:] @ turn
        for k, marker in enumerate(markers):
            for corner in range(4):
                begin = first + geometry.column(marker) + 3 * corner
                by[n + 4 * k + corner, :, begin : begin + 3] = by_point[4 * k + corner]
        return pixels - np.concatenate([view.pixels, self.corners(view)]), by
