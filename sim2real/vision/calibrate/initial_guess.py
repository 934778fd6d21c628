"""The initial guess of the bundle adjustment: each camera from its measured points on a flat table, then the markers
by triangulation."""

from __future__ import annotations

import numpy as np

from sim2real.vision.calibrate.calibration_view import CalibrationView
from sim2real.vision.calibrate.input_checks import checked_pose
from sim2real.vision.camera import CameraModel
from sim2real.vision.coordinate_warp import CoordinateWarp
from sim2real.vision.motion import rotation
from sim2real.vision.surface import Surface
from sim2real.vision.table_geometry import TableGeometry


def initial_guess(
    camera: CameraModel, views: tuple[CalibrationView, ...], height: float, middle: tuple[float, float]
) -> tuple[np.ndarray, TableGeometry]:
    """Camera poses (views, 6) and a geometry with a flat surface.

    height: of the puck's mark above the surface [m]; middle: of the table (x, y) [m]. Markers that only one view shows
    are left out, because they cannot be triangulated. Raises ValueError, in one line, if a view's points fail the input
    checks.
    """
    poses = [checked_pose(camera, view, height) for view in views]
    often = [marker for view in views for marker in view.corners]
    markers = {}
    for marker in sorted(set(often)):
        if often.count(marker) > 1:
            seen = [
                (pose, view.corners[marker]) for pose, view in zip(poses, views, strict=True) if marker in view.corners
            ]
            markers[marker] = np.array([_triangulated(camera, seen, k) for k in range(4)])
    places = np.concatenate([view.places for view in views])
    low, high = places.min(axis=0), places.max(axis=0)
    box = ((float(low[0]), float(low[1])), (float(high[0]), float(high[1])))
    return np.array(poses), TableGeometry(Surface(middle), CoordinateWarp(box), markers)


def _triangulated(camera: CameraModel, seen: list[tuple[np.ndarray, np.ndarray]], corner: int) -> np.ndarray:
    """The point (3,) [m] nearest, in least squares, to the rays in which cameras see a corner (0 to 3) of a marker.

    seen: of each camera its pose (6,) and the marker's corners (4, 2) [pixels].
    """
    left, right = np.zeros((3, 3)), np.zeros(3)
    for motion, corners in seen:
        turn = rotation(motion[:3])
        ray = turn.T @ np.append(camera.rays(corners[corner : corner + 1])[0], 1.0)
        across = np.eye(3) - np.outer(ray, ray) / (ray @ ray)
        left += across
        right -= across @ turn.T @ motion[3:]
    return np.linalg.lstsq(left, right)[0]
