"""The camera's pose from the corners of markers whose places are known (resection)."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from sim2real.vision.calibrate.residuals import CORNER_STD
from sim2real.vision.calibrate.robust_fit import robust_fit
from sim2real.vision.camera import CameraModel
from sim2real.vision.camera_file import Setup
from sim2real.vision.markers import FEWEST
from sim2real.vision.motion import apply_motion, rotation
from sim2real.vision.table_geometry import TableGeometry

# px rms of markers' corners: a right calibration by two views alone has 0.2 to 0.4 in a third photograph of the real
# table and 0.2 on made-up ones; one marker of six that is 5 mm off makes 0.7 to 1.6
FAR = 1.0
LOST = 3.0  # px rms: above it a pose is meaningless; up to it a check on an unused view measures the error


@dataclass(frozen=True)
class Pose:
    """A camera's pose.

    motion: (6,) rotation vector [rad] and shift [m] from the table's rigid frame to the camera's; covariance: (6, 6) of
    the motion, given exact markers; residuals: (n, 2) projected minus detected corners [pixels].
    """

    motion: np.ndarray
    covariance: np.ndarray
    residuals: np.ndarray

    @property
    def origin(self) -> np.ndarray:
        """The camera's place (3,) [m] in the table's rigid frame."""
        return -rotation(self.motion[:3]).T @ self.motion[3:]

    @property
    def rms(self) -> float:
        """Root mean square of the corners' residuals [pixels]."""
        return float(np.sqrt((self.residuals**2).sum(axis=1).mean()))

    @property
    def rms_of_markers(self) -> np.ndarray:
        """Root mean square (n / 4,) of each marker's residuals [pixels]."""
        return np.sqrt((self.residuals**2).sum(axis=1).reshape(-1, 4).mean(axis=1))


def rough_pose(camera: CameraModel, points: np.ndarray, pixels: np.ndarray) -> np.ndarray:
    """An approximate motion (6,) that projects points (n, 3) [m], n at least 4, near to their pixels (n, 2), by SQPnP.
    Raises ValueError if there is none."""
    rays = camera.rays(pixels)
    found, turn, shift = cv2.solvePnP(points, rays, np.eye(3), np.zeros(4), flags=cv2.SOLVEPNP_SQPNP)
    if not found:
        raise ValueError("no place of the camera shows the points where they are seen")
    return np.concatenate([turn.ravel(), shift.ravel()])


def find_pose(camera: CameraModel, points: np.ndarray, pixels: np.ndarray) -> Pose:
    """The pose of a camera that sees points (n, 3) [m] at pixels (n, 2), by robust least squares. Raises ValueError, in
    one line, if there is none."""

    def evaluate(motion: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        seen, by, _ = apply_motion(motion, points)
        found, by_seen = camera.project(seen)
        return ((found - pixels) / CORNER_STD).ravel(), (by_seen @ by / CORNER_STD).reshape(-1, 6)

    fitted = robust_fit(lambda _: evaluate, rough_pose(camera, points, pixels), np.zeros(len(points), int))
    residuals = CORNER_STD * evaluate(fitted.vector)[0].reshape(-1, 2)
    return Pose(fitted.vector, fitted.covariance, residuals)


def camera_pose(setup: Setup, geometry: TableGeometry, corners: dict[int, np.ndarray], most: float = FAR) -> Pose:
    """The pose of a camera that sees markers' corners, (4, 2) [pixels] by id, over a calibrated table.

    Raises ValueError, in one line, if it sees fewer than three of the calibration's markers, or if the residuals exceed
    `most` [pixels, root mean square]; the text names a single marker that is responsible, if there is one.
    """
    shared = [marker for marker in geometry.markers if marker in corners]
    if len(shared) < FEWEST:
        raise ValueError(
            f"{len(shared)} of the calibration's {len(geometry.markers)} markers are seen; expected {FEWEST} at least"
        )
    pose = _pose_of(setup.camera, geometry, corners, shared)
    if pose.rms <= most:
        return pose
    said = f"markers are {pose.rms:.1f} px rms from where the calibration has them; expected {most:g} at most: "
    if len(shared) > FEWEST:
        rest = {one: _pose_of(setup.camera, geometry, corners, [k for k in shared if k != one]).rms for one in shared}
        best = min(rest, key=lambda one: rest[one])
        if rest[best] <= most:
            raise ValueError(
                f"{said}it is marker {best}, without it the rest are {rest[best]:.2f} px off; was it moved since "
                "puckpilot calibrate table, or is an edge of it hidden? Put it right, or calibrate again"
            )
    worst = int(np.argmax(pose.rms_of_markers))
    raise ValueError(
        f"{said}marker {shared[worst]} worst, by {pose.rms_of_markers[worst]:.1f} px; were markers moved since, is "
        "table.json of this table, camera.json of this camera and lens? If so, calibrate again"
    )


def _pose_of(camera: CameraModel, geometry: TableGeometry, corners: dict[int, np.ndarray], markers: list[int]) -> Pose:
    """The pose from the given markers."""
    points = np.concatenate([geometry.markers[marker] for marker in markers])
    return find_pose(camera, points, np.concatenate([corners[marker] for marker in markers]))
