"""Launches kept apart: no fit sees them, not even the sensing's; they serve the proof alone. How large the noise of
their own recording is they tell with the others, which is the same before and after.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.contacts import geometry, mallet_tracks
from sim2real.diagnose.glide.data import GlideData, glide_data
from sim2real.diagnose.impacts import glide_before
from sim2real.diagnose.pieces import Pieces
from sim2real.recording import Recording

KEPT_APART = 4  # every so manieth launch, about, serves the proof alone


@dataclass(frozen=True)
class Launches:
    """The launches of several recordings, counted through all of them.

    `of_row`: for each recording, the number (frames,) of the launch that each row of its frames belongs to; `apart`:
    the numbers of those that serve the proof alone; `heldout`: whether these are whole recordings.
    """

    of_row: tuple[np.ndarray, ...]
    apart: np.ndarray
    heldout: bool

    def is_apart(self, launch: np.ndarray) -> np.ndarray:
        """Which of the launches, by their numbers, serve the proof alone."""
        return np.isin(launch, self.apart)

    def clusters_apart(self, recordings: Sequence[Recording], parts: Sequence[GlideData]) -> np.ndarray:
        """The clusters of the joined `parts`, each of a recording, that hold a glide of a launch kept apart."""
        found, before = [np.zeros(0, int)], 0
        for of_row, recording, part in zip(self.of_row, recordings, parts, strict=True):
            here = self.is_apart(of_row[_rows(recording, part)])
            found.append(np.unique(part.cluster[here]) + before)
            before += part.clusters
        return np.concatenate(found).astype(int)


def keep_apart(recordings: Sequence[Recording], pieces: Sequence[Pieces], heldout: int) -> Launches:
    """The launches of the last `heldout` recordings or, where there are none, about every KEPT_APART-th, among them
    some that meet walls and some that meet the robot's mallet, if any do."""
    of_row, first, met = [], [0], []
    for recording, some in zip(recordings, pieces, strict=True):
        part = _launched(recording, some, 0.0)
        _, opening = np.unique(part.cluster, return_index=True)
        begun = _rows(recording, part)[opening]
        frames = 0 if recording.frames is None else recording.frames.rows
        of_row.append(first[-1] + np.maximum(np.searchsorted(begun, np.arange(frames), side="right") - 1, 0))
        first.append(first[-1] + max(part.clusters, 1))
        met.append(_met(some, part))
    if heldout:
        return Launches(tuple(of_row), np.arange(first[len(recordings) - heldout], first[-1]), True)
    return Launches(tuple(of_row), _chosen(np.concatenate(met)), False)


def _met(pieces: Pieces, part: GlideData) -> np.ndarray:
    """How many hits of walls and of the robot's mallet each launch (launches, 2) has between two glides."""
    met = np.zeros((max(part.clusters, 1), 2), int)
    begin, finish = part.t[part.first[:-1]], part.t[part.first[1:] - 1]
    for k, hit in enumerate(pieces.hits):
        before = glide_before(pieces, begin, finish, k)
        if before is not None and (hit.kind == "wall" or hit.where == "robot"):
            met[part.cluster[before + 1], int(hit.where == "robot")] += 1
    return met


def _chosen(met: np.ndarray) -> np.ndarray:
    """Every KEPT_APART-th of the launches that `met` (launches, kinds) so many; where none of them met a kind, one that
    did takes the place of one that is not missed."""
    apart = list(range(KEPT_APART - 1, len(met), KEPT_APART))
    for kind in range(met.shape[1]):
        others = [k for k in np.flatnonzero(met[:, kind]) if k not in apart]
        if not apart or not others or met[apart, kind].any():
            continue
        spare = min(apart, key=lambda k: _missed(met, [one for one in apart if one != k], k))
        apart[apart.index(spare)] = int(others[len(others) // 2])
    return np.array(sorted(apart), int)


def _missed(met: np.ndarray, rest: list[int], k: int) -> tuple[int, int]:
    """How many kinds launch `k` alone has met of those kept apart, `rest` beside it; and how many hits it has."""
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
