"""Where the camera is: from the corners of markers whose places are known."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from sim2real.vision.calibrate.residuals import CORNER_STD
from sim2real.vision.calibrate.robust_fit import robust_fit
from sim2real.vision.camera import Camera
from sim2real.vision.camera_file import Setup
from sim2real.vision.markers import FEWEST
from sim2real.vision.motion import moved, rotation
from sim2real.vision.scene import Scene

# px rms of markers' corners: a right calibration by two views alone has 0.2 to 0.4 in a third photograph of the real
# table and 0.2 on made-up ones; one marker of six that is 5 mm off makes 0.7 to 1.6
FAR = 1.0
LOST = 3.0  # px rms: beyond it no robust fit nor check tells anything; up to it a check tells how far off all is


@dataclass(frozen=True)
class Pose:
    """`motion` (6,): rotation vector and shift [m] from the table's rigid frame to the camera's; `covariance` (6, 6):
    how uncertain it is where the markers are certain; `residuals` (n, 2): stated less seen of each corner [pixels]."""

    motion: np.ndarray
    covariance: np.ndarray
    residuals: np.ndarray

    @property
    def origin(self) -> np.ndarray:
        """Where the camera is (3,) [m]."""
        return -rotation(self.motion[:3]).T @ self.motion[3:]

    @property
    def rms(self) -> float:
        """Root mean square of the corners' residuals [pixels]."""
        return float(np.sqrt((self.residuals**2).sum(axis=1).mean()))

    @property
    def rms_of_markers(self) -> np.ndarray:
        """The same of each marker (n / 4,)."""
        return np.sqrt((self.residuals**2).sum(axis=1).reshape(-1, 4).mean(axis=1))


def rough_pose(camera: Camera, points: np.ndarray, pixels: np.ndarray) -> np.ndarray:
    """A motion (6,) that brings points (n, 3) [m], n at least 4, near to where they are seen (n, 2)."""
    rays = camera.rays(pixels)
    found, turn, shift = cv2.solvePnP(points, rays, np.eye(3), np.zeros(4), flags=cv2.SOLVEPNP_SQPNP)
    if not found:
        raise ValueError("no place of the camera shows the points where they are seen")
    return np.concatenate([turn.ravel(), shift.ravel()])


def find_pose(camera: Camera, points: np.ndarray, pixels: np.ndarray) -> Pose:
    """Where the camera is that sees corners (n, 3) [m] at pixels (n, 2). ValueError, in one line, if nowhere."""

    def evaluate(motion: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        seen, by, _ = moved(motion, points)
        found, by_seen = camera.project(seen)
        return ((found - pixels) / CORNER_STD).ravel(), (by_seen @ by / CORNER_STD).reshape(-1, 6)

    fitted = robust_fit(lambda _: evaluate, rough_pose(camera, points, pixels), np.zeros(len(points), int))
    residuals = CORNER_STD * evaluate(fitted.vector)[0].reshape(-1, 2)
    return Pose(fitted.vector, fitted.covariance, residuals)


def camera_pose(setup: Setup, scene: Scene, corners: dict[int, np.ndarray], most: float = FAR) -> Pose:
    """Where the camera is that sees markers' corners, id -> (4, 2) [pixels]. ValueError, in one line, if it sees too
    few of them, or sees them elsewhere than this scene has them, by more than `most` [pixels, rms]."""
    shared = [marker for marker in scene.markers if marker in corners]
    if len(shared) < FEWEST:
        raise ValueError(
            f"{len(shared)} of the calibration's {len(scene.markers)} markers are seen; expected {FEWEST} at least"
        )
    pose = _pose_of(setup.camera, scene, corners, shared)
    if pose.rms <= most:
        return pose
    said = f"markers are {pose.rms:.1f} px rms from where the calibration has them; expected {most:g} at most: "
    if len(shared) > FEWEST:
        rest = {one: _pose_of(setup.camera, scene, corners, [k for k in shared if k != one]).rms for one in shared}
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


def _pose_of(camera: Camera, scene: Scene, corners: dict[int, np.ndarray], markers: list[int]) -> Pose:
    """Where the camera is by some of the markers."""
    points = np.concatenate([scene.markers[marker] for marker in markers])
    return find_pose(camera, points, np.concatenate([corners[marker] for marker in markers]))
