"""Identify the sensor errors from all recordings of one table, and correct the recordings for them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim2real.diagnose.regimes.sensing.clock import (
    EXACT,
    Clock,
    ClockFit,
    TimedContacts,
    gaps_of_others,
    timed_contacts,
)
from sim2real.diagnose.regimes.sensing.clock_findings import ClockResult, identify_clock
from sim2real.diagnose.regimes.sensing.consistency import check_sensing
from sim2real.diagnose.regimes.sensing.coordinate_scale import ScaleResult, distances_of_others, identify_scale
from sim2real.diagnose.regimes.sensing.held_out import HeldOutErrors, held_out_errors
from sim2real.diagnose.regimes.sensing.repeated_frames import (
    deviation_errors,
    moving_frames,
    repeated_frames_finding,
)
from sim2real.diagnose.regimes.sensing.stamp_jitter import (
    MECHANISM,
    identify_stamps,
    stamp_errors,
    with_regular_stamps,
)
from sim2real.diagnose.result.pooled_proof import pooled
from sim2real.diagnose.result.result import RegimeResult
from sim2real.diagnose.sensor_noise.model import stated_map_error
from sim2real.recording.folder import Recording, Stream
from sim2real.segmentation.causes import geometry
from sim2real.segmentation.mallet_path import robot_path
from sim2real.segmentation.segments import Segments, segment
from sim2real.segmentation.velocity_jumps import VelocityJump, velocity_jumps

Launch = Sequence[np.ndarray]  # for each recording, the number (frames,) of each row's launch
PLACES = (("puck_x", "puck_y"), ("opponent_x", "opponent_y"))  # columns of frames


def corrected(recording: Recording, scale: np.ndarray, clock: Clock = EXACT) -> Recording:
    """Correct `recording` for the map error `scale` (3,), in the order of `coordinate_scale.NAMES`, and for `clock`."""
    if recording.frames is None:
        return recording
    columns = dict(recording.frames.columns)
    for x, y in PLACES:
        columns[y] = columns[y] / (1 + scale[1])
        columns[x] = (columns[x] - scale[2] * columns[y]) / (1 + scale[0])
    columns["t"] = np.asarray(clock.encoder_time(columns["t"]))
    return replace(recording, frames=Stream(columns))


@dataclass(frozen=True)
class IdentifiedSensing:
    """The result of the sensing regime, and the corrected recordings with their segments.

    `scale` (3,): the map error, in the order of `coordinate_scale.NAMES`; `clock`: None if no clock error was found;
    `period` [s]: of exposures that are taken to be regular, None where the stamps are.
    """

    regime_result: RegimeResult
    recordings: tuple[Recording, ...]
    segments: tuple[Segments, ...]
    scale: np.ndarray
    clock: ClockFit | None
    period: float | None = None

    def correct(self, recording: Recording) -> Recording:
        """Correct another recording of the same camera."""
        timed = recording if self.period is None else with_regular_stamps(recording, self.period)
        mapped = corrected(timed, self.scale) if self.scale.any() else timed
        return mapped if self.clock is None else corrected(mapped, np.zeros(3), self.clock.clock)


def identify_sensing(
    recordings: Sequence[Recording], segments: Sequence[Segments], launch: Launch
) -> IdentifiedSensing:
    """Identify the sensor errors in recordings of one table: the stamps, the map, the clock, the repeated frames.

    Errors: UndeterminedError if the recordings are not of one table and one camera. Jitter of stamps moves the places
    at which the puck bounces, so that these are compared when the stamps are known.
    """
    recordings, segments = list(recordings), list(segments)
    stamps = identify_stamps(recordings, segments, launch)
    if stamps.finding is not None:
        recordings = [with_regular_stamps(one, stamps.period) for one in recordings]
        segments = [segment(one) for one in recordings]
    check_sensing(recordings, segments)
    found = _velocity_jumps(recordings, segments, launch)
    calibrated = any(stated_map_error(one) for one in recordings)
    scale = identify_scale([s for part in found for s in part], geometry(recordings[0]), calibrated)
    if scale.findings:
        recordings = [corrected(one, scale.values) for one in recordings]
        segments = [segment(one) for one in recordings]
        found = _velocity_jumps(recordings, segments, launch)
    clock = identify_clock(_timed_contacts(recordings, found))
    held, held_selection = repeated_frames_finding(
        [moving_frames(*each) for each in zip(recordings, segments, launch, strict=True)]
    )
    if clock.fit is not None:
        recordings = [corrected(one, np.zeros(3), clock.clock) for one in recordings]
        segments = [segment(one) for one in recordings]
    single = [one for one in (held, stamps.finding) if one is not None]
    findings = sorted((*clock.findings, *scale.findings, *single), key=lambda one: one.p_value)
    selections = clock.selection, scale.selection, held_selection, stamps.selection
    selection = pooled([one for one in selections if one is not None])
    advice = _next_recording(recordings, clock, scale)
    regime_result = RegimeResult("sensing", tuple(findings), {}, not findings, selection, scale.undetermined, advice)
    every = tuple(recordings), tuple(segments)
    return IdentifiedSensing(regime_result, *every, scale.values, clock.fit, stamps.period)


def prove_sensing(
    sensed: IdentifiedSensing, recordings: Sequence[Recording], segments: Sequence[Segments], launch: Launch
) -> RegimeResult:
    """Add to the result the errors in holdout `recordings` and their `segments`, before and after correction."""
    g, recordings, segments = geometry(recordings[0]), list(recordings), list(segments)
    errors = {}
    if sensed.period is not None:
        errors[MECHANISM] = stamp_errors(recordings, segments, launch, sensed.period)
        recordings = [with_regular_stamps(one, sensed.period) for one in recordings]
        segments = [segment(one) for one in recordings]
    found = _velocity_jumps(recordings, segments, launch)
    jumps = [jump for part in found for jump in part]
    errors["scale_error"] = held_out_errors(*distances_of_others(jumps, sensed.scale, g).T)
    if sensed.scale.any():
        recordings = [corrected(one, sensed.scale) for one in recordings]
        segments = [segment(one) for one in recordings]
        found = _velocity_jumps(recordings, segments, launch)
    contacts = [one for one in _timed_contacts(recordings, found) if len(one.t)]
    if sensed.clock is not None and contacts:
        errors |= dict.fromkeys(
            ("camera_delay", "clock_drift"), held_out_errors(*gaps_of_others(contacts, sensed.clock))
        )
    errors["held_frames"] = deviation_errors(
        [moving_frames(*each) for each in zip(recordings, segments, launch, strict=True)]
    )
    named = {one.mechanism: errors.get(one.mechanism) for one in sensed.regime_result.findings}
    findings = tuple(_with(one, named[one.mechanism]) for one in sensed.regime_result.findings)
    known = {id(one): one.proof for one in named.values() if one is not None}
    return replace(sensed.regime_result, findings=findings, proof=pooled(list(known.values())))


def _with(finding, sizes: HeldOutErrors | None):
    return finding if sizes is None else replace(finding, before=sizes.before, after=sizes.after)


def _velocity_jumps(
    recordings: Sequence[Recording], segments: Sequence[Segments], launch: Launch
) -> list[list[VelocityJump]]:
    """The velocity jumps of each recording, with the number of their launch."""
    found = []
    for one, part, of_row in zip(recordings, segments, launch, strict=True):
        found.append([replace(s, launch=int(of_row[s.contact.frames[0]])) for s in velocity_jumps(one, part)])
    return found


def _timed_contacts(recordings: Sequence[Recording], found: Sequence[list[VelocityJump]]) -> list[TimedContacts]:
    read = [(robot_path(one) if part else None, one, part) for one, part in zip(recordings, found, strict=True)]
    return [timed_contacts(part, encoders, geometry(one)) for encoders, one, part in read if encoders is not None]


def _next_recording(recordings: list[Recording], clock: ClockResult, scale: ScaleResult) -> str:
    if scale.findings or scale.undetermined:
        return "measure the table's length and width: a wrong stated size looks like a stretched map"
    has_mallet = any(one.mallet is not None for one in recordings)
    if not clock.determined and has_mallet and any(one.frames is not None and one.frames.rows for one in recordings):
        return "to measure the camera's delay, record a minute in which the moving mallet of the robot hits the puck"
    return ""
