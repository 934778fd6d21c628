"""When the puck may have touched the robot's mallet, and pushed or held it: in contacts, whose times are known to some
milliseconds, in hits so soon before or after another that no path tells them, or pinched between mallet and wall."""

from __future__ import annotations

import numpy as np

from sim2real.recording.folder import Recording
from sim2real.segmentation.causes import geometry, mallet_tracks
from sim2real.segmentation.segments import Segments
from sim2real.segmentation.tuned import SEGMENTATION

FASTEST = 10.0  # m/s of the puck beside the mallet; a place that would need more is wrong
AROUND = 1.2  # of a frame's period before and after a frame that shows it
CLOSE = 0.002  # s between the times that are given: no window of the mallet's path lies between two of them


def possible_touches(recording: Recording, segments: Segments) -> np.ndarray:
    """Times (n,) [s], close to each other: about each contact of the puck with the robot's mallet, and about each frame
    in which it was so near that it may have touched it before the next."""
    contacts = np.array([contact.t for contact in segments.contacts if contact.where == "robot"])
    frames = recording.frames
    if frames is None or len(frames.t) < 2:
        return contacts
    side = AROUND * float(np.median(np.diff(frames.t)))
    around = np.arange(-side, side + 0.5 * CLOSE, CLOSE)
    times = np.concatenate([contacts, frames.t[_near(recording, segments)]])
    return np.unique((times[:, None] + around).ravel())


def _near(recording: Recording, segments: Segments) -> np.ndarray:
    """Whether each frame shows the puck so near to the robot's mallet. Places that no path explains count, since often
    they are between two hits."""
    frames = recording.frames
    assert frames is not None
    robot = mallet_tracks(recording, frames.t).get("robot")
    if robot is None:
        return np.zeros(len(frames.t), bool)
    g, period = geometry(recording), float(np.median(np.diff(frames.t)))
    puck = np.stack([frames["puck_x"], frames["puck_y"]], axis=1)
    puck[segments.held] = np.nan
    offset = puck - robot.place
    speed = np.fmin(np.linalg.norm(np.diff(offset, axis=0), axis=1) / np.diff(frames.t), FASTEST)
    moved = np.fmax(np.fmax(np.append(speed, 0.0), np.append(0.0, speed)), 0.0) * period  # m in a frame's period
    reach = g.puck_radius + g.mallet_radius + SEGMENTATION.place_slack + 0.5 * moved
    return np.linalg.norm(offset, axis=1) < reach  # of a place that was not seen: no
