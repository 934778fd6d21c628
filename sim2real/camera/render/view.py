"""The renderer's camera. It projects as OpenCV does.

The vision has a camera model of its own, so that a mistake in one projection cannot cancel in the other. A kernel does
the sums of `cv2.projectPoints`, which computes derivatives too, in a tenth of the time; a test compares the two.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np

from puckpilot_env.kernel import kernel
from sim2real.camera.render.coverage import cut

SIZE = (1440, 1080)  # columns and rows of the real table's camera during play
FOCAL = 1152.0  # pixels; this and the values below are the rounded calibration at 2048 columns, scaled to SIZE
PRINCIPAL_POINT = (716.0, 543.0)  # pixels
DISTORTION = (-0.128, 0.156, 0.0012, -0.0002, -0.065)
PLACE = (-0.19, 0.5, 0.665)  # of the real table's camera, in lengths, widths and lengths of the table
TARGET = (0.305, 0.5)  # the point that it looks at, in lengths and widths
PIECE = 0.02  # focal lengths, longest piece of a straight edge before the distortion is applied


@dataclass(frozen=True)
class CameraView:
    """A camera and its pose. Table's frame: x forward, y left, z up [m]; camera's: x right, y down, z ahead.

    matrix: (3, 3), focal lengths and principal point [pixels], the first pixel's centre at (0, 0); distortion: k1, k2,
    p1, p2, k3 (report B.1); rotation: (3,) vector and shift: (3,) [m], from the table's frame to the camera's; size:
    columns and rows.
    """

    matrix: np.ndarray
    distortion: np.ndarray
    rotation: np.ndarray
    shift: np.ndarray
    size: tuple[int, int] = SIZE

    @classmethod
    def like_the_real_one(cls, length: float, width: float) -> CameraView:
        """The real camera's view, from behind the robot's end, scaled to a table of this length and width [m]."""
        scale = np.array([length, width, length])
        return cls.from_place(scale * PLACE, scale * (*TARGET, 0.0))

    @classmethod
    def from_place(cls, place: np.ndarray, target: np.ndarray) -> CameraView:
        """The real table's camera at `place`, looking at `target` (3,) [m], with the horizon level."""
        ahead = np.asarray(target, float) - place
        right = np.cross(ahead, (0.0, 0.0, 1.0))
        axes = np.array([right, np.cross(ahead, right), ahead])
        turn = axes / np.linalg.norm(axes, axis=1, keepdims=True)
        matrix = np.array([[FOCAL, 0.0, PRINCIPAL_POINT[0]], [0.0, FOCAL, PRINCIPAL_POINT[1]], [0.0, 0.0, 1.0]])
        return cls(matrix, np.array(DISTORTION), cv2.Rodrigues(turn)[0].ravel(), -turn @ place)

    @cached_property
    def turn(self) -> np.ndarray:
        """`rotation` as a matrix (3, 3)."""
        return cv2.Rodrigues(self.rotation)[0]

    @cached_property
    def place(self) -> np.ndarray:
        """The camera's place (3,) [m] in the table's frame."""
        return -self.turn.T @ self.shift

    def project(self, points: np.ndarray) -> np.ndarray:
        """Pixels (n, 2), u and v, of points (n, 3) in the table's frame [m]."""
        return self._pixels(np.asarray(points, float), self.turn, self.shift)

    def silhouette(self, points: np.ndarray) -> np.ndarray:
        """The outline (m, 2) [pixels] of the convex hull of points (n, 3) [m]."""
        seen = points @ self.turn.T + self.shift
        rays = (seen[:, :2] / seen[:, 2:]).astype(np.float32)  # convexHull takes no doubles; 1e-4 pixels are lost
        corners = cv2.convexHull(rays)[:, 0].astype(float)
        edges, _ = cut(corners, PIECE)
        return self._pixels(np.column_stack([edges, np.ones(len(edges))]), np.eye(3), np.zeros(3))

    def _pixels(self, points: np.ndarray, turn: np.ndarray, shift: np.ndarray) -> np.ndarray:
        """Pixels (n, 2) of points (n, 3) [m] that a motion brings into the camera's frame."""
        pixels = np.empty((len(points), 2))
        _project(points, turn, shift, self.matrix, self.distortion, pixels)
        return pixels

    def brightness(self) -> np.ndarray:
        """The illumination float32 (rows, columns) of the table's plane by the lamp beside the camera, at each pixel.

        It falls with the square of the distance and is 1 in the middle of the picture; interpolated between every 16th
        pixel.
        """
        columns, rows = self.size
        v, u = np.mgrid[0.0 : rows + 16 : 16, 0.0 : columns + 16 : 16]
        pixels = np.stack([u.ravel(), v.ravel()], axis=1)
        rays = cv2.undistortPoints(pixels[:, None], self.matrix, self.distortion)[:, 0]
        down = np.column_stack([rays, np.ones(len(rays))]) @ -self.turn[:, 2]
        steep = np.maximum(down / np.sqrt(1.0 + (rays**2).sum(axis=1)), 0.0)
        coarse = ((steep / -self.turn[2, 2]) ** 2).reshape(u.shape).astype(np.float32)
        v, u = np.mgrid[0:rows, 0:columns].astype(np.float32) / 16.0
        return cv2.remap(coarse, u, v, cv2.INTER_LINEAR)

    def brightness_at(self, point: np.ndarray) -> float:
        """The illumination of a point (3,) [m] in the table's frame, relative to the middle of the picture."""
        middle = self.place[2] / -self.turn[2, 2]  # from the camera to where it looks
        return float(middle**2 / ((point - self.place) ** 2).sum())


@kernel
def _project(points, turn, shift, matrix, distortion, pixels):
    """Write the pixels (n, 2) of points (n, 3) [m], turned by (3, 3) and shifted by (3,) [m], of a camera with this
    matrix (3, 3) and distortion (k1, k2, p1, p2, k3), report B.1."""
    k1, k2, p1, p2, k3 = distortion[0], distortion[1], distortion[2], distortion[3], distortion[4]
    for i in range(points.shape[0]):
        a, b, c = points[i, 0], points[i, 1], points[i, 2]
        x = turn[0, 0] * a + turn[0, 1] * b + turn[0, 2] * c + shift[0]
        y = turn[1, 0] * a + turn[1, 1] * b + turn[1, 2] * c + shift[1]
        z = 1.0 / (turn[2, 0] * a + turn[2, 1] * b + turn[2, 2] * c + shift[2])
        x *= z
        y *= z
        r2 = x * x + y * y
        r4 = r2 * r2
        radial = 1.0 + k1 * r2 + k2 * r4 + k3 * (r4 * r2)
        cross, along, down = 2.0 * x * y, r2 + 2.0 * x * x, r2 + 2.0 * y * y
        pixels[i, 0] = (x * radial + p1 * cross + p2 * along) * matrix[0, 0] + matrix[0, 2]
        pixels[i, 1] = (y * radial + p1 * down + p2 * cross) * matrix[1, 1] + matrix[1, 2]
