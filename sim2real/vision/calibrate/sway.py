"""What each photograph has to say about a camera's intrinsics, its board's place apart: how sure all of them together
are, and which one the others contradict.

OpenCV states deviations too, but takes what the photographs do not tell at all (a focal length, of boards that face the
camera) for known exactly: it inverts the normal matrix without its least eigenvalues.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

POSE, INTRINSICS = 6, 9  # numbers of each board's place, and of the camera
KNOWN = 1e-12  # least eigenvalue, against the largest, of what is known at all


@dataclass(frozen=True)
class Sway:
    """Of each photograph of n corners, in directions that a move of its board cannot reach: residuals (2 n) [pixels]
    of a fit, and their derivatives (2 n, 9) by what OpenCV orders fx, fy, cx, cy, k1, k2, p1, p2, k3."""

    residuals: list[np.ndarray]
    by_camera: list[np.ndarray]

    @property
    def freedom(self) -> np.ndarray:
        """Each photograph's residuals less what the board's place takes."""
        return np.array([len(one) - POSE for one in self.residuals])

    def std(self) -> np.ndarray:
        """Standard deviations (9) of the intrinsics, huge where nothing tells them."""
        scale, matrix = self._scaled()
        _, values, axes = np.linalg.svd(np.concatenate(matrix), full_matrices=False)
        values = np.maximum(values, 1e-30)
        noise = np.sqrt(self._sum() / (self.freedom.sum() - INTRINSICS))
        return noise * np.linalg.norm(axes.T / values, axis=1) / scale

    def apart(self) -> tuple[np.ndarray, np.ndarray]:
        """Of each photograph how far [pixels, rms] its corners are off where the others alone put the camera, allowing
        for what the others do not know; and how far the others' are off then. To first order, by what the sum of
        squares loses without it (Cook and Weisberg 1982, ch. 3)."""
        _, matrix = self._scaled()
        squares = [one.T @ one for one in matrix]
        whole, all_freedom = sum(squares), self.freedom.sum() - INTRINSICS
        own, rest = [], []
        for residual, by, square, freedom in zip(self.residuals, matrix, squares, self.freedom, strict=True):
            pull = by.T @ residual
            lost = residual @ residual + pull @ np.linalg.pinv(whole - square, KNOWN, hermitian=True) @ pull
            own.append(lost / freedom)
            rest.append(max(self._sum() - lost, 0.0) / (all_freedom - freedom))
        return np.sqrt(2.0 * np.array(own)), np.sqrt(2.0 * np.array(rest))  # of points, of two residuals each

    def _sum(self) -> float:
        return float(sum(one @ one for one in self.residuals))

    def _scaled(self) -> tuple[np.ndarray, list[np.ndarray]]:
        """The derivatives' lengths (9), and the derivatives with these made 1."""
        scale = np.linalg.norm(np.concatenate(self.by_camera), axis=0)
        return scale, [one / scale for one in self.by_camera]


def sway(
    seen: list[tuple[np.ndarray, np.ndarray]], matrix: np.ndarray, bent: np.ndarray, motions: list[np.ndarray]
) -> Sway:
    """Of corners on the board (n, 3) and in the picture (n, 2), of a fit's camera matrix and distortion, and of its
    boards' rotation vectors and shifts (6,)."""
    residuals, by_camera = [], []
    for (places, pixels), motion in zip(seen, motions, strict=True):
        expected, by = cv2.projectPoints(places.astype(float), motion[:3], motion[3:], matrix, bent)
        reach = np.linalg.qr(by[:, :POSE])[0]
        residual, slope = (pixels - expected[:, 0]).ravel(), by[:, POSE : POSE + INTRINSICS]
        residuals.append(residual - reach @ (reach.T @ residual))
        by_camera.append(slope - reach @ (reach.T @ slope))
    return Sway(residuals, by_camera)
