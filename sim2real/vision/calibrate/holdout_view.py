"""The test of a calibration on a view that was not used in it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.vision.calibrate.calibration_view import CalibrationView
from sim2real.vision.calibrate.input_checks import checked_pose
from sim2real.vision.calibrate.pose import LOST, Pose, camera_pose
from sim2real.vision.camera_file import Setup
from sim2real.vision.locate import Locator
from sim2real.vision.table_geometry import TableGeometry


@dataclass(frozen=True)
class HoldoutCheck:
    """The errors of a calibration on an unused view.

    pose: of the camera, from the photograph's markers alone; off: (n, 2) [m], where each point is found on the table
    minus where it was measured.
    """

    view: CalibrationView
    pose: Pose
    off: np.ndarray

    @property
    def distances(self) -> np.ndarray:
        """Distances (n,) [m] between found and measured points."""
        return np.hypot(*self.off.T)


def check_holdout(setup: Setup, geometry: TableGeometry, view: CalibrationView) -> HoldoutCheck:
    """Find the points of an unused view on the table and compare them with the measured ones. Raises ValueError, in
    one line, if the points fail the input checks or the camera's pose is not found."""
    checked_pose(setup.camera, view, setup.puck_top)
    pose = camera_pose(setup, geometry, view.corners, LOST)
    locator = Locator(setup.camera, pose.motion, geometry.surface, geometry.warp)
    return HoldoutCheck(view, pose, locator.places(view.pixels, setup.puck_top) - view.places)
