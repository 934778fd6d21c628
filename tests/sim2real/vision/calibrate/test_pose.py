"""The camera's place from markers alone: its error bars, faults that do no harm, and markers that were moved."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sim2real.vision.calibrate.pose import camera_pose
from sim2real.vision.table_geometry import TableGeometry
from tests.sim2real.vision import world
from tests.sim2real.vision.calibrate.test_multiview import SETUP, fit, view

MOTION = world.camera_motion(world.CAMERA_PLACES[3])


def seen(markers: dict[int, np.ndarray], noise: float = 0.0, seed: int = 0) -> dict[int, np.ndarray]:
    """Corners as camera 3 sees them."""
    rng = np.random.default_rng(seed)
    return {name: world.seen(MOTION, one) + rng.normal(0.0, noise, (4, 2)) for name, one in markers.items()}


def known() -> TableGeometry:
    return replace(fit().geometry, markers=world.markers())


def test_the_pose_is_as_uncertain_as_it_says():
    """Of 40 photographs with errors of 0.1 px: squares of six numbers over their covariance are 6 on average."""
    square = []
    for seed in range(40):
        pose = camera_pose(SETUP, known(), seen(world.markers(), 0.1, seed))
        off = pose.motion - MOTION
        square.append(off @ np.linalg.solve(pose.covariance, off))
    assert 4.0 < np.mean(square) < 9.0


def test_a_corner_that_is_seen_wrong_does_no_harm():
    corners = {**view(3).corners, 2: view(3).corners[2] + [[3.0, -2.0], [0, 0], [0, 0], [0, 0]]}
    pose = camera_pose(SETUP, fit().geometry, corners)
    np.testing.assert_allclose(pose.origin, world.CAMERA_PLACES[3], atol=3e-3)
    assert np.hypot(*pose.residuals[8]) == pytest.approx(3.6, abs=0.3)


@pytest.mark.parametrize("moved", [0, 4])
def test_a_marker_that_was_moved_is_named(moved: int):
    markers = {**world.markers(), moved: world.markers()[moved] + [0.0, 0.02, 0.0]}
    output = (
        rf"markers are \d\.\d px rms from .* expected 1 at most: it is marker {moved}, without it the rest are 0\.0"
    )
    with pytest.raises(ValueError, match=output):
        camera_pose(SETUP, fit().geometry, seen(markers))


def test_of_three_markers_the_worst_is_named():
    markers = {name: world.markers()[name] + [0.05 * (name == 4), 0.0, 0.0] for name in (0, 2, 4)}
    with pytest.raises(
        ValueError, match=r"expected 1 at most: marker \d worst, by \d+\.\d px; were markers moved since"
    ):
        camera_pose(SETUP, fit().geometry, seen(markers))


def test_another_tables_markers_are_reported():
    off = (
        np.random.default_rng(1).uniform(0.05, 0.1, (6, 3))
        * [1.0, 1.0, 0.0]
        * np.tile([[-1, 1, 1], [1, -1, 1]], (3, 1))
    )
    markers = {name: one + off[name] for name, one in world.markers().items()}
    with pytest.raises(
        ValueError, match=r"markers are \d+\.\d px rms .* marker \d worst, .* is table\.json of this table"
    ):
        camera_pose(SETUP, fit().geometry, seen(markers))


def test_two_markers_are_too_few():
    corners = {name: view(1).corners[name] for name in (0, 1)}
    with pytest.raises(ValueError, match="2 of the calibration's 6 markers are seen; expected 3"):
        camera_pose(SETUP, fit().geometry, corners)
