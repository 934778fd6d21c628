"""Locate a camera in one picture, also where its short exposure leaves the markers hardly brighter than the dark.

The markers that are detected give a first pose, and that says where all others must be seen: their edges, fitted to
hundreds of pixels, are found where the detector of whole markers finds nothing. In such pictures black is clipped, so
all edges of ink lie a little outwards, alike for all markers: this spread is estimated with the pose.
"""

from __future__ import annotations

import numpy as np

from sim2real.vision.calibrate.pose import FAR, Pose, camera_pose
from sim2real.vision.camera import CameraModel
from sim2real.vision.camera_file import Setup
from sim2real.vision.edges import refine
from sim2real.vision.markers import BORDER, detect_markers, dictionary_of
from sim2real.vision.motion import apply_motion
from sim2real.vision.photograph import smoothed
from sim2real.vision.table_geometry import TableGeometry

CONTRAST = 3.0  # grey levels, least step of an edge whose place is known beforehand
MARGIN = 6.0  # px, least distance of a marker's corners from the picture's border
ROUNDS = 4  # of predicting and refining, at most
ROUGH = 3.0  # px rms, greatest of corners that are not yet refined, or not yet without their spread
STEPS = 3  # of alternating between spread and pose
MOST_SPREAD = 1.0  # px


def find_camera(setup: Setup, geometry: TableGeometry, image: np.ndarray) -> tuple[Pose, dict[int, np.ndarray]]:
    """The pose of the camera that took a picture uint8 (rows, columns) of a calibrated table, and the corners (4, 2)
    [pixels] of the markers that it was found by, without their spread.

    The picture may be the raw mosaic of a colour sensor. Raises ValueError, in one line, if fewer than three markers
    are seen or they are not where the calibration has them.
    """
    even = smoothed(image)
    corners, before = detect_markers(even, setup.dictionary), set()
    for _ in range(ROUNDS):
        pose = camera_pose(setup, geometry, corners, ROUGH)
        corners = _refined(setup, geometry, pose.motion, even)
        if set(corners) == before:
            break
        before = set(corners)
    return _without_spread(setup, geometry, corners)


def clear_markers(
    setup: Setup, geometry: TableGeometry, motion: np.ndarray, image: np.ndarray
) -> dict[int, np.ndarray]:
    """The corners (4, 2) [pixels], by marker, of those that a picture uint8 (rows, columns) clearly shows where a
    camera with this motion (6,) must see them."""
    due = _corners_in_picture(setup.camera, geometry, motion, image.shape)
    found = _refined(setup, geometry, motion, smoothed(image))
    return {name: one for name, one in found.items() if np.abs(one - due[name]).max() < MOST_SPREAD + FAR}


def _refined(setup: Setup, geometry: TableGeometry, motion: np.ndarray, even: np.ndarray) -> dict[int, np.ndarray]:
    """The refined corners (4, 2) [pixels], by marker, of those with clear edges in a smoothed picture (rows, columns)
    near to where a camera with this motion (6,) sees them."""
    cells = dictionary_of(setup.dictionary).markerSize + BORDER
    due = _corners_in_picture(setup.camera, geometry, motion, even.shape)
    fine = {name: refine(even, setup.camera, one, cells, CONTRAST) for name, one in due.items()}
    return {name: one for name, one in fine.items() if one is not None}


def _corners_in_picture(
    camera: CameraModel, geometry: TableGeometry, motion: np.ndarray, shape: tuple[int, ...]
) -> dict[int, np.ndarray]:
    """The corners (4, 2) [pixels] of the markers that a camera with this motion (6,) sees as a whole in a picture of a
    shape (rows, columns)."""
    found = {name: camera.project(apply_motion(motion, one)[0])[0] for name, one in geometry.markers.items()}
    limit = np.array(shape[::-1]) - 1.0 - MARGIN
    return {name: one for name, one in found.items() if ((one >= MARGIN) & (one <= limit)).all()}


def _without_spread(
    setup: Setup, geometry: TableGeometry, corners: dict[int, np.ndarray]
) -> tuple[Pose, dict[int, np.ndarray]]:
    """The pose from corners (4, 2) [pixels] by marker, whose edges all lie a common spread outwards, and the corners
    without it."""
    outwards = {name: _outwards(one) for name, one in corners.items() if name in geometry.markers}
    even, spread = corners, 0.0
    pose = camera_pose(setup, geometry, even, ROUGH)
    for _ in range(STEPS):
        along = np.concatenate([outwards[name] for name in geometry.markers if name in outwards])
        spread -= float((pose.residuals * along).sum() / (along**2).sum())
        spread = float(np.clip(spread, -MOST_SPREAD, MOST_SPREAD))
        even = {name: one - spread * outwards[name] for name, one in corners.items() if name in outwards}
        pose = camera_pose(setup, geometry, even, ROUGH)
    return camera_pose(setup, geometry, even, FAR), even


def _outwards(corners: np.ndarray) -> np.ndarray:
    """The shifts (4, 2) [pixels] of a marker's corners (4, 2) if each of its edges moves outwards by one pixel."""
    sides = np.roll(corners, -1, axis=0) - corners
    normals = np.stack([sides[:, 1], -sides[:, 0]], axis=1) / np.linalg.norm(sides, axis=1, keepdims=True)
    normals *= np.sign(((corners - corners.mean(axis=0)) * normals).sum(axis=1, keepdims=True))
    both = np.stack([np.roll(normals, 1, axis=0), normals], axis=1)
    return np.linalg.solve(both, np.ones((4, 2, 1)))[:, :, 0]
