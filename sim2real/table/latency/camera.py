"""The camera's parts: by a ring on the robot's mallet, or by its contacts with the puck, against the encoders."""

from __future__ import annotations

import numpy as np

from sim2real.diagnose.regimes.sensing.clock import fit_clock, search_clock, timed_contacts
from sim2real.recording.folder import Recording
from sim2real.segmentation.causes import geometry
from sim2real.segmentation.mallet_path import robot_path
from sim2real.segmentation.segments import segment
from sim2real.segmentation.velocity_jumps import velocity_jumps
from sim2real.statistics.intervals import reach
from sim2real.table.latency.part import Kind, Part
from sim2real.table.latency.path_shift import NotDeterminedError, PathShift, path_shift

DELAY = ("camera", "exposure to the frame's stamp")
DRIFT = ("camera_drift", "gain of the camera's clock")
RING, CONTACTS = "the mallet's ring against its encoders", "contacts with the puck against the encoders"
NO_RING = (
    "no frame shows a ring at the robot's mallet; put the opponent's reflective ring there, where the camera sees it"
)
PPM = 1e6


def has_ring(recording: Recording) -> bool:
    """Whether some frame shows the ring on the robot's mallet."""
    frames = recording.frames
    return frames is not None and "robot_x" in frames and bool(np.isfinite(frames["robot_x"]).any())


def shift_of_ring(recording: Recording, about: float = 0.0) -> PathShift:
    """The shift of the frames' stamps against the encoders', about `about` [s], by the ring on the robot's mallet.
    NotDeterminedError if the recording does not tell."""
    frames, mallet = recording.frames, recording.mallet
    if frames is None or not has_ring(recording):
        raise NotDeterminedError(NO_RING)
    if mallet is None:
        raise NotDeterminedError("the mallet's path was not recorded (mallet.csv)")
    path = np.column_stack([mallet["mallet_x"], mallet["mallet_y"]])
    return path_shift(mallet.t, path, frames.t, np.column_stack([frames["robot_x"], frames["robot_y"]]), about)


def by_ring(shift: PathShift, clock_error: float = 0.0, drift_error: float = 0.0) -> list[Part]:
    """Delay, at the middle of the measurement, and drift of the camera's stamps.

    clock_error [s], drift_error [1]: bounds of the error of the encoders' stamps on the host's clock.
    """
    return [
        Kind(*DELAY, RING).found(shift.delay, shift.delay_half + clock_error),
        Kind(*DRIFT, RING, "ppm").found(PPM * shift.rate, PPM * (shift.rate_half + drift_error)),
    ]


def by_contacts(recording: Recording) -> list[Part]:
    """Delay, at the middle of the contacts, and drift of the camera's stamps, as `puckpilot diagnose` finds them."""
    kinds = Kind(*DELAY, CONTACTS), Kind(*DRIFT, CONTACTS, "ppm")
    try:
        (delay, delay_half), (rate, rate_half) = _clock_of_contacts(recording.from_zero())
    except NotDeterminedError as why:
        return [kind.unknown(str(why)) for kind in kinds]
    return [kinds[0].found(delay, delay_half), kinds[1].found(PPM * rate, PPM * rate_half)]


def _clock_of_contacts(recording: Recording) -> tuple[tuple[float, float], tuple[float, float]]:
    """Delay [s] at the middle and rate [1], each with half of its interval."""
    if recording.frames is None or not recording.frames.rows or recording.mallet is None:
        raise NotDeterminedError("it takes both streams, frames.csv and mallet.csv")
    encoders = robot_path(recording)
    if encoders is None:
        raise NotDeterminedError("mallet.csv is too short")
    found = timed_contacts(velocity_jumps(recording, segment(recording)), encoders, geometry(recording))
    fitted = fit_clock([found], search_clock([found]), (True, True)) if len(found.t) >= 2 else None
    if fitted is None or fitted.freedom < 3:
        raise NotDeterminedError("the moving mallet hits the puck too few times: record a minute of rallies")
    middle, wide = float(np.mean(found.t)), reach(fitted.freedom)
    clock, at = fitted.clock, np.array([1.0, middle])
    halves = wide * np.sqrt([float(at @ clock.covariance @ at), float(clock.covariance[1, 1])])
    return (clock.delay + middle * clock.rate, float(halves[0])), (clock.rate, float(halves[1]))
