"""Hits with the motion before and after them, told by the whole glides on both sides under the fitted law."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sim2real.diagnose.contacts import NEAR, wall_axis
from sim2real.diagnose.glide.carry import carried
from sim2real.diagnose.glide.problem import GlideProblem, States
from sim2real.diagnose.hits import Hit
from sim2real.diagnose.pieces import Pieces

FARTHEST = 0.12  # s from a glide's last frame to the hit
FAR_OFF = 6.0  # standard deviations
SPIN_UNTOLD = ("post", "unexplained")  # the normal is uncertain, and so is the spin that such a contact gives


@dataclass(frozen=True)
class Side:
    """Motion at the time of a hit: place (2,) [m], velocity (2,) [m/s], and the covariance (4, 4) of both.

    `drift` (4, k): changes of both by each independent standard deviation of the fitted law, common to all hits.
    """

    place: np.ndarray
    velocity: np.ndarray
    covariance: np.ndarray
    drift: np.ndarray


@dataclass(frozen=True)
class Impact:
    """A hit between two glides. `cluster`: its launch; `before`, `after`: the motion on both sides at its time.

    `chain`: impacts of one number follow each other without a gap; `lost`: an earlier contact of the launch is not
    among its chain, so that the puck's spin is unknown. `since` [s]: time since the contact before, nan where that is
    unknown. `glide`: index of the glide that follows, among those of the recording.
    """

    hit: Hit
    cluster: int
    before: Side
    after: Side
    chain: int
    lost: bool
    since: float
    glide: int


def find_impacts(pieces: Pieces, problem: GlideProblem, states: States, recording: int = 0) -> list[Impact]:
    """The hits of `pieces` that a fitted glide leads to and another one from, in order of time.

    `pieces` are those of the problem's recording of that number, `states` the ends of all its glides.
    """
    data = problem.data
    here = np.flatnonzero(data.recording == recording)
    if not len(here):
        return []
    begin, finish = data.t[data.first[here]], data.t[data.first[here + 1] - 1]
    near = FAR_OFF * problem.place_error_m or NEAR  # a wall's line is where the camera sees it
    found: list[Impact] = []
    for k, hit in enumerate(pieces.hits):
        before = glide_before(pieces, begin, finish, k)
        if before is None:
            continue
        after = before + 1
        left, right = (
            _carry(states, here[glide], end, hit.t - at)
            for glide, end, at in ((before, 1, finish[before]), (after, 0, begin[after]))
        )
        hit = _told_by(left, right, hit, pieces.lines, near)
        cluster = int(data.cluster[here[after]])
        last = found[-1] if found and found[-1].glide == before else None
        since = hit.t - last.hit.t if last else np.nan
        if last and last.hit.kind not in SPIN_UNTOLD:
            chain, lost = last.chain, last.lost
        else:
            chain, lost = int(here[after]), _touched_before(pieces, hit)
        found.append(Impact(hit, cluster, left, right, chain, lost, since, after))
    return found


def glide_before(pieces: Pieces, begin: np.ndarray, finish: np.ndarray, k: int) -> int | None:
    """The glide that leads to hit `k` of `pieces`, of glides from `begin` to `finish` (n,) [s]; None for a hit without
    one right before and another right after it."""
    hit = pieces.hits[k]
    before = int(np.searchsorted(begin, hit.t)) - 1
    after = before + 1
    if before < 0 or after >= len(begin) or hit.t < finish[before] - 0.01:
        return None
    near = hit.t - finish[before] <= FARTHEST and begin[after] - hit.t <= FARTHEST
    return before if near and not _others(pieces, k, finish[before], begin[after]) else None


def _touched_before(pieces: Pieces, hit: Hit) -> bool:
    """Whether the launch had another contact before `hit`."""
    begun = max((start for start, _ in pieces.launches if start <= hit.frames[0]), default=0)
    return any(other.t < hit.t and other.frames[0] >= begun for other in pieces.hits)


def _others(pieces: Pieces, k: int, start: float, stop: float) -> bool:
    """Whether another hit lies between the same two glides."""
    near = [pieces.hits[i] for i in (k - 1, k + 1) if 0 <= i < len(pieces.hits)]
    return any(start - 0.005 < other.t < stop + 0.005 for other in near)


def _told_by(before: Side, after: Side, hit: Hit, lines: dict[str, float], near: float) -> Hit:
    """The hit, if the wall that it is said to be of is where both motions meet, within `near` [m] beside the noise.
    What a beam hides may have been another thing, such as a blow of the mallet under it."""
    if hit.kind != "wall":
        return hit
    axis, _ = wall_axis(hit.where)
    places = np.array([side.place[axis] for side in (before, after)])
    variances = np.array([side.covariance[axis, axis] for side in (before, after)])
    weights = 1.0 / np.maximum(variances, 1e-18)
    place, std = float(weights @ places / weights.sum()), float(weights.sum() ** -0.5)
    if abs(place - lines[hit.where]) < near + FAR_OFF * std:
        return hit
    return replace(hit, kind="unexplained", where="nothing near")


def _carry(states: States, glide: int, end: int, duration: float) -> Side:
    """The motion at an end of a glide, `duration` later (or before, if it is negative)."""
    place, velocity, beyond = np.split(states.motion[glide, end], 3)
    moved = np.eye(4)
    moved[0, 2] = moved[1, 3] = duration
    return Side(
        *carried(place, velocity, beyond, states.friction, states.drag, duration),
        moved @ states.spread[glide, end] @ moved.T,
        moved @ states.drift[glide, end],
    )
