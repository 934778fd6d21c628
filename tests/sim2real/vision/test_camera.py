"""The projection and its derivatives against OpenCV's, and the way back."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from sim2real.vision.camera import CameraModel
from sim2real.vision.motion import apply_motion, rotation
from tests.sim2real.vision.world import DISTORTION, SIZE, K

CAMERA = CameraModel(K[0, 0], K[1, 1], K[0, 2], K[1, 2], tuple(DISTORTION), SIZE)
MOTIONS = [np.array(one) for one in ([0.3, -0.4, 2.5, 0.1, 0.2, 3.0], [1e-9, 2e-9, 0, 0, 0, 2.0], [0, 0, 0, 0, 0, 2.0])]


def points() -> np.ndarray:
    return np.random.default_rng(1).uniform(-0.8, 0.8, (60, 3))


@pytest.mark.parametrize("motion", MOTIONS)
def test_pixels_and_derivatives_are_opencvs(motion: np.ndarray):
    theirs, by = cv2.projectPoints(points(), motion[:3], motion[3:], K, DISTORTION)
    seen, by_motion, turn = apply_motion(motion, points())
    ours, by_point = CAMERA.project(seen)
    np.testing.assert_allclose(ours, theirs[:, 0], atol=1e-9)
    np.testing.assert_allclose((by_point @ by_motion).reshape(-1, 6), by[:, :6], atol=1e-6)
    np.testing.assert_allclose(turn, cv2.Rodrigues(motion[:3])[0], atol=1e-12)


def test_derivatives_by_points_are_differences():
    seen = points() + np.array([0.0, 0.0, 3.0])
    by = CAMERA.project(seen)[1]
    for axis in range(3):
        step = 1e-6 * np.eye(3)[axis]
        slope = (CAMERA.project(seen + step)[0] - CAMERA.project(seen - step)[0]) / 2e-6
        np.testing.assert_allclose(by[:, :, axis], slope, atol=1e-4)


def test_rays_of_a_whole_picture_are_opencvs():
    u, v = np.meshgrid(np.arange(0, SIZE[0], 64.0), np.arange(0, SIZE[1], 64.0))
    pixels = np.stack([u.ravel(), v.ravel()], axis=1)
    theirs = cv2.undistortPoints(pixels[:, None], K, DISTORTION, criteria=(3, 100, 1e-14))[:, 0]
    np.testing.assert_allclose(CAMERA.rays(pixels), theirs, atol=1e-10)
    np.testing.assert_allclose(CAMERA.distort(CAMERA.undistort(pixels)), pixels, atol=1e-9)


def test_what_cannot_be_seen_is_nan():
    assert np.isnan(CAMERA.project(np.array([[0.1, 0.1, -1.0], [0.0, 0.0, 0.0]]))[0]).all()
    folding = CameraModel(500.0, 500.0, 320.0, 240.0, (-0.5, 0.0, 0.0, 0.0, 0.0))
    assert np.isnan(folding.rays(np.array([[900.0, 240.0]]))).all()
    assert np.isfinite(folding.rays(np.array([[500.0, 240.0]]))).all()


def test_a_small_rotation_meets_the_large_ones():
    for angle in (0.99e-3, 1.01e-3):
        vector = angle * np.array([0.6, 0.0, 0.8])
        np.testing.assert_allclose(rotation(vector), cv2.Rodrigues(vector)[0], atol=1e-15)
