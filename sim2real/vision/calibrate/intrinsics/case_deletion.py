"""Case deletion: the influence of each photograph on a camera's intrinsics, and the intrinsics' standard deviations.

The pose of each board is projected out first. OpenCV states standard deviations too, but where the photographs leave a
parameter undetermined (the focal length, if all boards face the camera) it reports it as exact: it inverts the normal
matrix without its smallest eigenvalues.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

POSE, INTRINSICS = 6, 9  # parameters of each board's pose, and of the camera
KNOWN = 1e-12  # least eigenvalue, relative to the largest, of a combination that is determined


@dataclass(frozen=True)
class CaseDeletion:
    """The linearized fit of a camera's intrinsics, with the boards' poses projected out.

    residuals: for each photograph of n corners (2 n,) [pixels]; by_camera: for each (2 n, 9), derivatives by fx, fy,
    cx, cy, k1, k2, p1, p2, k3.
    """

    residuals: list[np.ndarray]
    by_camera: list[np.ndarray]

    @property
    def freedom(self) -> np.ndarray:
        """Degrees of freedom (photographs,) of the residuals: their number minus six for the board's pose."""
        return np.array([len(one) - POSE for one in self.residuals])

    def std(self) -> np.ndarray:
        """Standard deviations (9,) of the intrinsics; very large for what the photographs do not determine."""
        scale, matrix = self._scaled()
        _, values, axes = np.linalg.svd(np.concatenate(matrix), full_matrices=False)
        values = np.maximum(values, 1e-30)
        noise = np.sqrt(self._sum() / (self.freedom.sum() - INTRINSICS))
        return noise * np.linalg.norm(axes.T / values, axis=1) / scale

    def deleted_rms(self) -> tuple[np.ndarray, np.ndarray]:
        """For each photograph (photographs,), fitted without it: root mean square residuals [pixels] of its own
        corners, allowing for the uncertainty of the fit, and of the other photographs' corners.

        To first order, from the decrease of the sum of squares without the photograph (Cook and Weisberg 1982, ch. 3).
        """
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
        """The lengths (9,) of the derivatives' columns, and the derivatives divided by them."""
        scale = np.linalg.norm(np.concatenate(self.by_camera), axis=0)
        return scale, [one / scale for one in self.by_camera]


def delete_cases(
    seen: list[tuple[np.ndarray, np.ndarray]], matrix: np.ndarray, distortion: np.ndarray, motions: list[np.ndarray]
) -> CaseDeletion:
    """Linearize a fit.

    seen: for each photograph, corners on the board (n, 3) [squares] and in the picture (n, 2) [pixels]; matrix: (3, 3)
    of the camera; distortion: its distortion coefficients (5,); motions: of each board (6,), rotation vector and shift.
    """
    residuals, by_camera = [], []
    for (places, pixels), motion in zip(seen, motions, strict=True):
        expected, by = cv2.projectPoints(places.astype(float), motion[:3], motion[3:], matrix, distortion)
        reach = np.linalg.qr(by[:, :POSE])[0]
        residual, slope = (pixels - expected[:, 0]).ravel(), by[:, POSE : POSE + INTRINSICS]
        residuals.append(residual - reach @ (reach.T @ residual))
        by_camera.append(slope - reach @ (reach.T @ slope))
    return CaseDeletion(residuals, by_camera)
