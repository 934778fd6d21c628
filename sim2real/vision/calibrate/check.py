"""A calibration on trial: a view that it never saw."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.vision.calibrate.plausible import plausible_pose
from sim2real.vision.calibrate.pose import LOST, Pose, camera_pose
from sim2real.vision.calibrate.view import View
from sim2real.vision.camera_file import Setup
from sim2real.vision.locate import Locator
from sim2real.vision.scene import Scene


@dataclass(frozen=True)
class Checked:
    """`pose`: the camera's, from the photograph's markers alone; `off` (n, 2) [m]: where each point is found on the
    table less where it was measured."""

    view: View
    pose: Pose
    off: np.ndarray

    @property
    def distances(self) -> np.ndarray:
        """How far off each point (n,) is found [m]."""
        return np.hypot(*self.off.T)


def check(setup: Setup, scene: Scene, view: View) -> Checked:
    """Find a view's points on the table and hold them against the measured ones. ValueError, in one line, if they
    cannot be what the view shows."""
    plausible_pose(setup.camera, view, setup.puck_top)
    pose = camera_pose(setup, scene, view.corners, LOST)
    locator = Locator(setup.camera, pose.motion, scene.surface, scene.bend)
    return Checked(view, pose, locator.places(view.pixels, setup.puck_top) - view.places)
