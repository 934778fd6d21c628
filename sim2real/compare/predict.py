"""Predict each segment of a recording with the simulator, and compute the prediction errors."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from sim2real.compare.contacts import ContactError, Spin, predict_mallet, predict_wall
from sim2real.compare.glides import GlideError, predict_glide, why_not_usable
from sim2real.compare.map_error import MapError
from sim2real.diagnose.engine.problem import record_of
from sim2real.diagnose.split import glides_of
from sim2real.recording.folder import Recording
from sim2real.segmentation.mallet_path import opponent_path, robot_path
from sim2real.segmentation.segments import Segments
from sim2real.segmentation.sensor_noise import MotionNoise
from sim2real.segmentation.velocity_jumps import VelocityJump, velocity_jumps

UNEXPLAINED = "unexplained events"


@dataclass(frozen=True)
class Comparison:
    """The compared segments, and for each kind the reasons why others could not be compared (reason -> count)."""

    glides: tuple[GlideError, ...]
    walls: tuple[ContactError, ...]
    mallets: tuple[ContactError, ...]
    unusable: dict[str, Counter]


def compare_segments(recording: Recording, segments: Segments, values: dict[str, float]) -> Comparison:
    """Predict every usable segment of `recording` with the parameters `values`, by name, with those of effects."""
    unusable: dict[str, Counter] = {"glide": Counter(), "wall": Counter(), "mallet": Counter(), "other": Counter()}
    size = np.array([values["length"], values["width"]])
    noise = glides_of(recording, segments).noise[0].uniform
    map_error = MapError(size, recording.nominal("camera", "place_std_m") or 0.0)
    glides, p = [], record_of(values)
    for segment in segments.glides:
        reason = why_not_usable(segment)
        if reason:
            unusable["glide"][reason] += 1
        else:
            glides.append(predict_glide(segment, noise, map_error, p))
    walls, mallets = _contacts(recording, segments, values, noise, map_error, unusable)
    return Comparison(tuple(glides), tuple(walls), tuple(mallets), unusable)


def _contacts(
    recording: Recording,
    segments: Segments,
    values: dict[str, float],
    noise: MotionNoise,
    map_error: MapError,
    unusable: dict[str, Counter],
) -> tuple[list[ContactError], list[ContactError]]:
    """The contacts with walls and with mallets with their predictions; other contacts are counted in `unusable`."""
    jumps = velocity_jumps(recording, segments, values["friction"], values["drag"], noise)
    by_contact = {id(jump.contact): jump for jump in jumps}
    touched = {contact.where for contact in segments.of_kind("mallet")}
    read = {"robot": robot_path, "opponent": opponent_path}
    paths = {who: read[who](recording) for who in touched}
    walls, mallets, p, after_hand = [], [], record_of(values), _hand_let_go(recording, segments)
    last: tuple[VelocityJump, ContactError] | None = None
    for contact in segments.contacts:
        jump, found = by_contact.get(id(contact)), None
        if contact.kind not in ("wall", "mallet"):
            name = UNEXPLAINED if contact.kind == "unexplained" else "goal post contacts, not compared"
            unusable["other"][name] += 1
        elif not contact.clean or jump is None:
            unusable[contact.kind]["too few frames beside another event"] += 1
        elif contact.kind == "wall":
            found = predict_wall(jump, p, map_error, _spin(last, jump, after_hand, values))
            walls.append(found)
        else:
            path = paths[contact.where]
            found = path and predict_mallet(jump, path, p, map_error, _spin(last, jump, after_hand, values))
            if found is None:
                unusable["mallet"]["mallet not seen"] += 1
            else:
                mallets.append(found)
        last = (jump, found) if jump and found else None
    return walls, mallets


def _hand_let_go(recording: Recording, segments: Segments) -> set[int]:
    """The contacts, by their identity, that are the first after a hand let the puck go."""
    if recording.frames is None:
        return set()
    found, t = set(), recording.frames.t
    for (start, stop), let_go in zip(segments.launches, segments.let_go, strict=True):
        within = (one for one in segments.contacts if t[start] <= one.t <= t[stop - 1])
        first = next(within, None)
        if let_go and first is not None:
            found.add(id(first))
    return found


def _spin(
    last: tuple[VelocityJump, ContactError] | None, jump: VelocityJump, after_hand: set[int], values: dict[str, float]
) -> Spin:
    """The spin with which the puck comes to a contact: what the `last` one, of the same launch, left of it by its
    prediction; none for the first `after_hand` let the puck go; elsewhere it is not known."""
    if last is None or last[0].launch != jump.launch:
        return Spin(known=id(jump.contact) in after_hand)
    left = last[1].spin
    return Spin(left.value * float(np.exp(-values["spin_decay"] * (jump.t - last[0].t))), left.known)
