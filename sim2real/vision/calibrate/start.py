"""Where the joint search begins: each camera from its measured points on a flat table, then the markers by rays."""

from __future__ import annotations

import numpy as np

from sim2real.vision.bend import Bend
from sim2real.vision.calibrate.plausible import plausible_pose
from sim2real.vision.calibrate.view import View
from sim2real.vision.camera import Camera
from sim2real.vision.motion import rotation
from sim2real.vision.scene import Scene
from sim2real.vision.surface import Surface


def start(
    camera: Camera, views: tuple[View, ...], height: float, middle: tuple[float, float]
) -> tuple[np.ndarray, Scene]:
    """Motions (views, 6) of the cameras and a scene with a flat surface. Markers that one view alone shows have no
    place in it. ValueError, in one line, if a view's points cannot be what it shows."""
    poses = [plausible_pose(camera, view, height) for view in views]
    often = [marker for view in views for marker in view.corners]
    markers = {}
    for marker in sorted(set(often)):
        if often.count(marker) > 1:
            seen = [
                (pose, view.corners[marker]) for pose, view in zip(poses, views, strict=True) if marker in view.corners
            ]
            markers[marker] = np.array([_nearest(camera, seen, k) for k in range(4)])
    places = np.concatenate([view.places for view in views])
    low, high = places.min(axis=0), places.max(axis=0)
    box = ((float(low[0]), float(low[1])), (float(high[0]), float(high[1])))
    return np.array(poses), Scene(Surface(middle), Bend(box), markers)


def _nearest(camera: Camera, seen: list[tuple[np.ndarray, np.ndarray]], corner: int) -> np.ndarray:
    """The point (3,) nearest to the rays in which some cameras see a corner."""
    left, right = np.zeros((3, 3)), np.zeros(3)
    for motion, corners in seen:
        turn = rotation(motion[:3])
        ray = turn.T @ np.append(camera.rays(corners[corner : corner + 1])[0], 1.0)
        across = np.eye(3) - np.outer(ray, ray) / (ray @ ray)
        left += across
        right -= across @ turn.T @ motion[3:]
    return np.linalg.lstsq(left, right)[0]
