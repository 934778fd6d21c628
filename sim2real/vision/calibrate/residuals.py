"""How far all views are from a scene, in units of what their errors are taken to be, with analytic derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.vision.calibrate.view import View
from sim2real.vision.camera import Camera
from sim2real.vision.motion import moved
from sim2real.vision.scene import BEFORE, Scene
from sim2real.vision.surface import TERMS

# at the least, since what fits better fits by chance, or errs alike in all views; `robust_fit` finds how much more
CORNER_STD = 0.05  # px, of a marker's corner by `edges`
PIXEL_STD = 0.2  # px, of the puck's centre
PLACE_STD = 0.5e-3  # m, of a place measured by hand
PLACE, CORNER = 0, 1  # kinds of pairs of residuals
CURVATURE_STD = 0.02  # 1/m: 2 cm at 1 m from the middle, beyond any table that can be played on


@dataclass(frozen=True)
class Problem:
    """All views and the scene where the search begins. The vector of unknowns: six numbers for the camera of each
    view, then the scene's."""

    camera: Camera
    views: tuple[View, ...]
    scene: Scene
    height: float  # of the puck's mark above the surface [m]
    bend_std: float  # m, of each coefficient of the bend, before anything was seen

    def split(self, vector: np.ndarray) -> tuple[np.ndarray, Scene]:
        """The cameras' motions (views, 6) and the scene in a vector of unknowns."""
        many = 6 * len(self.views)
        return vector[:many].reshape(-1, 6), self.scene.replaced(vector[many:])

    def kinds(self) -> np.ndarray:
        """Of each pair of residuals (pairs,), in the order of `evaluate`, whether it is of a PLACE or of a CORNER."""
        return np.concatenate(
            [np.repeat([PLACE, CORNER], [len(view.pixels), len(self.corners(view))]) for view in self.views]
        )

    def evaluate(self, vector: np.ndarray, whitening: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Residuals (m,) and their derivatives (m, unknowns): of each view the measured points and the corners, each
        multiplied by its matrix of `whitening`; then what is known of bend and curvature before anything was seen."""
        poses, scene = self.split(vector)
        rows, slopes = [], []
        for k, (view, pose) in enumerate(zip(self.views, poses, strict=True)):
            off, by = self.of_view(view, pose, scene, 6 * k, len(vector))
            rows.append(np.einsum("nij,nj->ni", whitening[k], off).ravel())
            slopes.append((whitening[k] @ by).reshape(-1, len(vector)))
        first = 6 * len(self.views)
        std = np.r_[np.full(TERMS, CURVATURE_STD), np.full(BEFORE - TERMS, self.bend_std)]
        prior = np.zeros((BEFORE, len(vector)))
        prior[:, first : first + BEFORE] = np.diag(1.0 / std)
        return np.concatenate([*rows, vector[first : first + BEFORE] / std]), np.concatenate([*slopes, prior])

    def whitening(self, vector: np.ndarray) -> list[np.ndarray]:
        """For each view the matrices (points + corners, 2, 2) that turn pixels into standard deviations: a place
        measured by hand is uncertain on the table, a corner in the picture."""
        poses, scene = self.split(vector)
        found = []
        for view, pose in zip(self.views, poses, strict=True):
            by_place = self.by_place(view, pose, scene)
            spread = PLACE_STD**2 * by_place @ by_place.transpose(0, 2, 1) + PIXEL_STD**2 * np.eye(2)
            corners = np.broadcast_to(np.eye(2) / CORNER_STD, (4 * len(self._shared(view)), 2, 2))
            found.append(np.concatenate([np.linalg.inv(np.linalg.cholesky(spread)), corners]))
        return found

    def by_place(self, view: View, pose: np.ndarray, scene: Scene) -> np.ndarray:
        """Derivatives (n, 2, 2) of the pixels of a view's measured points by their places."""
        points = scene.points(view.places, self.height)
        seen, _, turn = moved(pose, points)
        slope = scene.surface.slope(points[:, :2])
        by = self.camera.project(seen)[1] @ turn
        return by[:, :, :2] + by[:, :, 2:] * slope[:, None, :]

    def pixels(self, view: View, pose: np.ndarray, scene: Scene) -> np.ndarray:
        """Where (n, 2) the scene has a view's measured points and then its corners."""
        corners = [scene.markers[marker] for marker in self._shared(view)]
        points = np.concatenate([scene.points(view.places, self.height), *corners])
        return self.camera.project(moved(pose, points)[0])[0]

    def corners(self, view: View) -> np.ndarray:
        """All corners (n, 2) of a view's markers that are in the scene."""
        return np.array([view.corners[marker] for marker in self._shared(view)]).reshape(-1, 2)

    def _shared(self, view: View) -> list[int]:
        return [marker for marker in self.scene.markers if marker in view.corners]

    def of_view(
        self, view: View, pose: np.ndarray, scene: Scene, column: int, many: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """Seen less stated [pixels] (n, 2) of a view, with derivatives (n, 2, unknowns)."""
        markers = self._shared(view)
        points = scene.points(view.places, self.height)
        seen, by_pose, turn = moved(pose, np.concatenate([points, *(scene.markers[marker] for marker in markers)]))
        pixels, by_seen = self.camera.project(seen)
        by = np.zeros((len(pixels), 2, many))
        by[:, :, column : column + 6] = by_seen @ by_pose
        first, n = 6 * len(self.views), len(points)
        by[:n, :, first : first + BEFORE] = by_seen[:n] @ turn @ scene.points_by(view.places)
        by_point = by_seen[n:] @ turn
        for k, marker in enumerate(markers):
            for corner in range(4):
                begin = first + scene.column(marker) + 3 * corner
                by[n + 4 * k + corner, :, begin : begin + 3] = by_point[4 * k + corner]
        return pixels - np.concatenate([view.pixels, self.corners(view)]), by
