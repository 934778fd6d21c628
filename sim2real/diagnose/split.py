"""What of the data finds laws, and what proves them.

The pieces that prove are taken out of the recordings before anything is looked for. They are whole recordings
(`--holdout`) or, where there are none, whole launches of the puck, and what the gantry did meanwhile (blocks of seconds
where no puck was launched). No fit, choice or correction ever sees them: `identify` is given the rest alone, in which
laws are selected by how well launches predict each other (`engine.selection`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from sim2real.diagnose.contacts import WALLS, geometry, mallet_tracks
from sim2real.diagnose.glide.data import GlideData, glide_data
from sim2real.diagnose.impacts import glide_before
from sim2real.diagnose.pieces import Pieces, cut
from sim2real.recording import Recording, Stream

PROVES = 6  # about every so manieth launch proves
KINDS = (
    *WALLS,
    "nothing near",
    "robot",
)  # of hits; of a table whose size is wrongly stated a wall is not where it should be
ENOUGH = 4  # hits of a kind, which the launches that do not prove keep: fewer do not tell where a wall is
LONGEST_BLOCK = 3.0  # s of the gantry's path, of which about every PROVES-th proves
FEWEST_BLOCKS = 20  # where the path is short


class Divided(NamedTuple):
    """Recordings less what proves, and what proves: of the puck's frames, and of the mallet's path. What one regime
    takes as given, such as the mallet's path for the puck's, stays whole."""

    rest: list[Recording]
    proof: list[Recording]
    gantry_rest: list[Recording]
    gantry_proof: list[Recording]


def divide(recordings: Sequence[Recording], heldout: Sequence[Recording]) -> Divided:
    """The recordings `heldout` prove or, where there are none, parts of the others."""
    if heldout:
        return Divided(list(recordings), list(heldout), list(recordings), list(heldout))
    pieces = [cut(one) for one in recordings]
    of_row, met = _launches(recordings, pieces)
    chosen = _every(PROVES, met)
    shows = [np.isin(rows, chosen) for rows in of_row]
    paths = [_path_that_proves(*each) for each in zip(recordings, of_row, shows, strict=True)]
    return Divided(
        [_only(one, "frames", ~some) for one, some in zip(recordings, shows, strict=True)],
        [_only(one, "frames", some) for one, some in zip(recordings, shows, strict=True)],
        [_only(one, "mallet", ~some) for one, some in zip(recordings, paths, strict=True)],
        [_only(one, "mallet", some) for one, some in zip(recordings, paths, strict=True)],
    )


def _only(one: Recording, stream: str, rows: np.ndarray) -> Recording:
    """A recording with some `rows` (n,) bool of one stream alone."""
    whole = getattr(one, stream)
    if whole is None:
        return one
    return replace(one, **{stream: Stream({name: column[rows] for name, column in whole.columns.items()})})


def _path_that_proves(one: Recording, of_row: np.ndarray, shows: np.ndarray) -> np.ndarray:
    """Which rows (n,) bool of the mallet's path prove: those during a launch that does, of whose blows the rest knows
    nothing, or some blocks of seconds where there is none."""
    if one.mallet is None or not one.mallet.rows:
        return np.zeros(0, bool)
    t = one.mallet.t
    if shows.any():
        assert one.frames is not None
        return shows[np.clip(np.searchsorted(one.frames.t, t, side="right") - 1, 0, len(of_row) - 1)]
    block = min(LONGEST_BLOCK, float(t[-1] - t[0]) / FEWEST_BLOCKS) or LONGEST_BLOCK
    return ((t - t[0]) // block).astype(int) % PROVES == PROVES - 1


def launches_of(recordings: Sequence[Recording], pieces: Sequence[Pieces]) -> tuple[np.ndarray, ...]:
    """For each recording, the number (frames,) of the launch of each row of its frames, counted through all of them."""
    return _launches(recordings, pieces)[0]


def _launches(recordings: Sequence[Recording], pieces: Sequence[Pieces]) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
    """The number of each row's launch, for each recording, and how many hits each launch (launches, KINDS) has met."""
    of_row, first, met = [], 0, []
    for recording, some in zip(recordings, pieces, strict=True):
        part = _launched(recording, some, 0.0)
        _, opening = np.unique(part.cluster, return_index=True)
        begun = _rows(recording, part)[opening]
        frames = 0 if recording.frames is None else recording.frames.rows
        of_row.append(first + np.maximum(np.searchsorted(begun, np.arange(frames), side="right") - 1, 0))
        first += max(part.clusters, 1)
        met.append(_met(some, part))
    return tuple(of_row), np.concatenate(met)


def _met(pieces: Pieces, part: GlideData) -> np.ndarray:
    """How many hits of each wall and of the robot's mallet each launch (launches, kinds) has between two glides."""
    met = np.zeros((max(part.clusters, 1), len(KINDS)), int)
    begin, finish = part.t[part.first[:-1]], part.t[part.first[1:] - 1]
    for k, hit in enumerate(pieces.hits):
        before = glide_before(pieces, begin, finish, k)
        if before is not None and hit.where in KINDS:
            met[part.cluster[before + 1], KINDS.index(hit.where)] += 1
    return met


def _every(step: int, met: np.ndarray) -> np.ndarray:
    """One of each `step` launches that `met` (launches, KINDS) so many hits, or one of fewer: the last that leaves the
    others ENOUGH of each kind, where there are so many. Where none of them met any wall, or the robot, one that did
    takes the place of one that is not missed."""
    ends = range(step, len(met) + 1, step) if len(met) >= step else [len(met)] * (len(met) > 1)
    chosen, left = [], met.sum(axis=0)
    for end in ends:
        some = range(end - 1, max(end - step, 0) - 1, -1)
        k = next((k for k in some if np.all((left - met[k] >= ENOUGH) | (met[k] == 0) | (left < ENOUGH))), end - 1)
        chosen.append(k)
        left = left - met[k]
    both = np.stack([met[:, :-1].sum(axis=1), met[:, -1]], axis=1)
    for kind in range(both.shape[1]):
        others = [k for k in np.flatnonzero(both[:, kind]) if k not in chosen]
        if not chosen or not others or both[chosen, kind].any():
            continue
        spare = min(chosen, key=lambda k: _missed(both, [one for one in chosen if one != k], k))
        chosen[chosen.index(spare)] = int(others[len(others) // 2])
    return np.array(sorted(chosen), int)


def _missed(met: np.ndarray, rest: list[int], k: int) -> tuple[int, int]:
    """How many kinds launch `k` alone has met of those chosen, `rest` beside it; and how many hits it has."""
    alone = (met[k] > 0) & ~met[rest].any(axis=0)
    return int(alone.sum()), int(met[k].sum())


def glides_of(recording: Recording, pieces: Pieces) -> GlideData:
    """The glides of a recording, with what its calibration says that it errs by."""
    return _launched(recording, pieces, recording.nominal("camera", "place_std_m") or 0.0)


def _launched(recording: Recording, pieces: Pieces, stated: float) -> GlideData:
    t = np.zeros(0) if recording.frames is None else recording.frames.t
    return glide_data(pieces, geometry(recording), mallet_tracks(recording, t), stated)


def _rows(recording: Recording, part: GlideData) -> np.ndarray:
    """The row (glides,) of the frames at which each glide begins."""
    if recording.frames is None:
        return np.zeros(0, int)
    return np.searchsorted(recording.frames.t, part.t[part.first[:-1]])
