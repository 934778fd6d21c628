"""A calibration on trial: a view that it never saw."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.vision.camera_file import Setup
from sim2real.vision.locate import Locator
from sim2real.vision.markers import FEWEST
from sim2real.vision.pose import Pose, find_pose
from sim2real.vision.scene import Scene
from sim2real.vision.view import View


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


def camera_pose(setup: Setup, scene: Scene, corners: dict[int, np.ndarray]) -> Pose:
    """Where the camera is that sees markers' corners, id -> (4, 2) [pixels]. ValueError if it sees too few of them."""
    shared = [marker for marker in scene.markers if marker in corners]
    if len(shared) < FEWEST:
        raise ValueError(
            f"{len(shared)} of the calibration's {len(scene.markers)} markers are seen; expected {FEWEST} at least"
        )
    points = np.concatenate([scene.markers[marker] for marker in shared])
    return find_pose(setup.camera, points, np.concatenate([corners[marker] for marker in shared]))


def check(setup: Setup, scene: Scene, view: View) -> Checked:
    """Find a view's points on the table and hold them against the measured ones."""
    pose = camera_pose(setup, scene, view.corners)
    locator = Locator(setup.camera, pose.motion, scene.surface, scene.frame)
    return Checked(view, pose, locator.places(view.pixels, setup.puck_top) - view.places)
