"""The renderer's projection against OpenCV's."""

from __future__ import annotations

import cv2
import numpy as np

from sim2real.camera.render.view import CameraView

VIEW = CameraView.like_the_real_one(2.0, 1.0)


def test_points_are_projected_as_by_opencv() -> None:
    points = np.random.default_rng(1).uniform((-0.2, -0.4, -0.1), (2.3, 1.4, 0.2), (500, 3))
    by_opencv = cv2.projectPoints(points, VIEW.rotation, VIEW.shift, VIEW.matrix, VIEW.distortion)[0][:, 0]
    np.testing.assert_allclose(VIEW.project(points), by_opencv, atol=1e-10, rtol=0.0)


def test_the_silhouette_of_a_triangle_runs_through_its_corners_as_opencv_projects_them() -> None:
    corners = np.array([(0.3, 0.2, 0.0), (1.1, 0.9, 0.05), (0.5, 0.7, 0.1)])
    by_opencv = cv2.projectPoints(corners, VIEW.rotation, VIEW.shift, VIEW.matrix, VIEW.distortion)[0][:, 0]
    outline = VIEW.silhouette(corners)
    nearest = np.linalg.norm(outline[None] - by_opencv[:, None], axis=2).min(axis=1)
    assert nearest.max() < 1e-3 and len(outline) > 20
