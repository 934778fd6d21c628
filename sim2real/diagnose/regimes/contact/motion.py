"""Contacts with the puck's motion on both sides, extrapolated from the glides before and after them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sim2real.diagnose.regimes.contact.tuned import CONTACT
from sim2real.diagnose.regimes.sliding.problem import GlideProblem, States
from sim2real.diagnose.regimes.sliding.trajectory import extrapolated
from sim2real.segmentation.causes import wall_axis
from sim2real.segmentation.events import ContactEvent
from sim2real.segmentation.segments import Segments
from sim2real.segmentation.tuned import SEGMENTATION

SPIN_UNPREDICTED = ("post", "unexplained")  # contacts whose normal, and therefore the spin after them, is uncertain


@dataclass(frozen=True)
class ContactSide:
    """The puck's motion on one side of a contact, at its time: `place` (2,) [m] and `velocity` (2,) [m/s].

    `covariance` (4, 4): of place and velocity due to sensor noise. `common_errors` (4, k): their changes by one
    standard deviation of each of k errors that all contacts share: those of the fitted glide law and of the
    calibration.
    """

    place: np.ndarray
    velocity: np.ndarray
    covariance: np.ndarray
    common_errors: np.ndarray


@dataclass(frozen=True)
class ContactMotion:
    """A contact between two glides, with the motion `before` and `after` it; `cluster`: its launch.

    `spin_chain`: contacts with the same number follow each other without a gap, so the puck's spin carries over.
    `spin_unknown`: the puck may have been turned before this chain, which begins with an unknown spin then.
    `time_since_contact` [s]: time since the previous contact, nan if unknown. `glide`: index of the following glide in
    the recording.
    """

    contact: ContactEvent
    cluster: int
    before: ContactSide
    after: ContactSide
    spin_chain: int
    spin_unknown: bool
    time_since_contact: float
    glide: int


def find_contact_motions(
    segments: Segments, problem: GlideProblem, states: States, recording: int = 0
) -> list[ContactMotion]:
    """Find the contacts of `segments` that lie between two fitted glides, in order of time.

    `segments`: of recording number `recording` of the problem; `states`: at the ends of all glides of the problem.
    """
    data = problem.data
    here = np.flatnonzero(data.recording == recording)
    if not len(here):
        return []
    begin, finish = data.t[data.first[here]], data.t[data.first[here + 1] - 1]
    near = (
        CONTACT.outlier_deviations * problem.place_error_m or SEGMENTATION.place_slack
    )  # contact lines are in the camera's coordinates
    found: list[ContactMotion] = []
    for k, contact in enumerate(segments.contacts):
        before = glide_before(segments, begin, finish, k)
        if before is None:
            continue
        after = before + 1
        left, right = (
            _extrapolate(states, here[glide], end, contact.t - at)
            for glide, end, at in ((before, 1, finish[before]), (after, 0, begin[after]))
        )
        contact = _check_wall(left, right, contact, segments.lines, near)
        cluster = int(data.cluster[here[after]])
        last = found[-1] if found and found[-1].glide == before else None
        time_since_contact = contact.t - last.contact.t if last else np.nan
        if last and last.contact.kind not in SPIN_UNPREDICTED:
            spin_chain, spin_unknown = last.spin_chain, last.spin_unknown
        else:
            spin_chain, spin_unknown = int(here[after]), _is_spin_unknown(segments, contact)
        found.append(ContactMotion(contact, cluster, left, right, spin_chain, spin_unknown, time_since_contact, after))
    return found


def glide_before(segments: Segments, begin: np.ndarray, finish: np.ndarray, k: int) -> int | None:
    """Index of the glide that ends at contact `k` of `segments`; the glides last from `begin` to `finish` (n,) [s].

    None if there is no glide directly before or after the contact, or if another contact lies in the same gap.
    """
    contact = segments.contacts[k]
    before = int(np.searchsorted(begin, contact.t)) - 1
    after = before + 1
    if before < 0 or after >= len(begin) or contact.t < finish[before] - CONTACT.glide_overlap:
        return None
    near = contact.t - finish[before] <= CONTACT.longest_gap and begin[after] - contact.t <= CONTACT.longest_gap
    return before if near and not _has_neighbour(segments, k, finish[before], begin[after]) else None


def _is_spin_unknown(segments: Segments, contact: ContactEvent) -> bool:
    """Whether the puck may have been turned before `contact`: since no hand let it go at the launch's beginning, or by
    a contact with anything but a mallet, over which the spin of a chain goes on, too."""
    number = max((k for k, (start, _) in enumerate(segments.launches) if start <= contact.frames[0]), default=0)
    begun = segments.launches[number][0] if segments.launches else 0
    before = [one for one in segments.contacts if one.t < contact.t and one.frames[0] >= begun]
    return not all(segments.let_go[number : number + 1]) or any(one.kind != "mallet" for one in before)


def _has_neighbour(segments: Segments, k: int, start: float, stop: float) -> bool:
    """Whether contact `k` shares the gap from `start` to `stop` [s] with another contact."""
    near = [segments.contacts[i] for i in (k - 1, k + 1) if 0 <= i < len(segments.contacts)]
    return any(start - CONTACT.neighbour_margin < other.t < stop + CONTACT.neighbour_margin for other in near)


def _check_wall(
    before: ContactSide, after: ContactSide, contact: ContactEvent, lines: dict[str, float], near: float
) -> ContactEvent:
    """Change the kind of a wall contact to "unexplained" if the motions before and after do not meet at the wall.

    They meet there if their weighted mean lies within `near` [m] plus its noise of the wall's contact line in `lines`
    [m]. A beam may hide another event, such as a contact with a mallet under it.
    """
    if contact.kind != "wall":
        return contact
    axis, _ = wall_axis(contact.where)
    places = np.array([side.place[axis] for side in (before, after)])
    variances = np.array([side.covariance[axis, axis] for side in (before, after)])
    weights = 1.0 / np.maximum(variances, 1e-18)
    place, std = float(weights @ places / weights.sum()), float(weights.sum() ** -0.5)
    if abs(place - lines[contact.where]) < near + CONTACT.outlier_deviations * std:
        return contact
    return replace(contact, kind="unexplained", where="nothing near")


def _extrapolate(states: States, glide: int, end: int, duration: float) -> ContactSide:
    """The motion `duration` [s] after the first (`end` 0) or last (1) frame of a glide; before it if negative."""
    place, velocity, more = np.split(states.motion[glide, end], 3)
    moved = np.eye(4)
    moved[0, 2] = moved[1, 3] = duration
    return ContactSide(
        *extrapolated(states.record, float(states.t[glide, end]), place, velocity, more, duration),
        moved @ states.spread[glide, end] @ moved.T,
        moved @ states.drift[glide, end],
    )
