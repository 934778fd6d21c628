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


@dataclass(frozen=True)
class Pose:
    """`motion` (6,): rotation vector and shift [m] from the table's rigid frame to the camera's; `std` (6,): how
    uncertain; `residuals` (n, 2): stated less seen of each corner [pixels]."""

    motion: np.ndarray
    std: np.ndarray
    residuals: np.ndarray

    @property
    def origin(self) -> np.ndarray:
        """Where the camera is (3,) [m]."""
        return -rotation(self.motion[:3]).T @ self.motion[3:]

    @property
    def rms(self) -> float:
        """Root mean square of the corners' residuals [pixels]."""
        return float(np.sqrt((self.residuals**2).sum(axis=1).mean()))


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
    return Pose(fitted.vector, np.sqrt(np.diag(fitted.covariance)), residuals)


def camera_pose(setup: Setup, scene: Scene, corners: dict[int, np.ndarray]) -> Pose:
    """Where the camera is that sees markers' corners, id -> (4, 2) [pixels]. ValueError if it sees too few of them."""
    shared = [marker for marker in scene.markers if marker in corners]
    if len(shared) < FEWEST:
        raise ValueError(
            f"{len(shared)} of the calibration's {len(scene.markers)} markers are seen; expected {FEWEST} at least"
        )
    points = np.concatenate([scene.markers[marker] for marker in shared])
    return find_pose(setup.camera, points, np.concatenate([corners[marker] for marker in shared]))
