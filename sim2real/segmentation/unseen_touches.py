"""When the puck may have touched the robot's mallet beside its known contacts, and pushed or held it: in a hit just
before a wall, or pinched between mallet and wall."""

from __future__ import annotations

import numpy as np

from sim2real.recording.folder import Recording
from sim2real.segmentation.causes import geometry, mallet_tracks
from sim2real.segmentation.segments import Segments
from sim2real.segmentation.tuned import SEGMENTATION

KNOWN = 3.0  # frames' periods about a contact whose time is known, in which the puck is still near
AROUND = 1.2  # of a frame's period before and after a frame that shows it
CLOSE = 0.002  # s between the times that are given: no window of the mallet's path lies between two of them


def unseen_touches(recording: Recording, segments: Segments) -> np.ndarray:
    """Times (n,) [s], close to each other, at which the puck was so near to the robot's mallet that it may have touched
    it between two frames, but for the contacts that are known."""
    frames = recording.frames
    if frames is None or len(frames.t) < 2:
        return np.zeros(0)
    robot = mallet_tracks(recording, frames.t).get("robot")
    if robot is None:
        return np.zeros(0)
    g, period = geometry(recording), float(np.median(np.diff(frames.t)))
    puck = np.stack([frames["puck_x"], frames["puck_y"]], axis=1)
    puck[segments.held | segments.wild] = np.nan
    offset = puck - robot.place
    moved = np.linalg.norm(np.diff(offset, axis=0), axis=1) / np.diff(frames.t) * period  # m in a frame's period
    moved = np.fmax(np.fmax(np.append(moved, 0.0), np.append(0.0, moved)), 0.0)
    reach = g.puck_radius + g.mallet_radius + SEGMENTATION.place_slack + 0.5 * moved
    near = np.linalg.norm(offset, axis=1) < reach  # of a place that was not seen: no
    known = np.array([contact.t for contact in segments.contacts if contact.where == "robot"])
    near &= np.all(np.abs(frames.t[:, None] - known) > KNOWN * period, axis=1)
    side = AROUND * period
    around = np.arange(-side, side + 0.5 * CLOSE, CLOSE)
    return np.unique((frames.t[near][:, None] + around).ravel())
