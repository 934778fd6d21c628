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

from sim2real.diagnose.regimes.contact.motion import glide_before
from sim2real.diagnose.regimes.sliding.data import GlideData, glide_data
from sim2real.diagnose.sensor_noise.model import stated_map_error
from sim2real.diagnose.tuned import SPLIT
from sim2real.recording.folder import Recording, Stream
from sim2real.segmentation.causes import WALLS, geometry, mallet_tracks
from sim2real.segmentation.segments import Segments, segment

# Kinds of contacts; where the table's size is wrongly stated, a wall is not where it should be
KINDS = (*WALLS, "nothing near", "robot")


class DataSplit(NamedTuple):
    """Recordings less what proves, and what proves: of the puck's frames, and of the mallet's path. What one regime
    takes as given, such as the mallet's path for the puck's, stays whole."""

    training: list[Recording]
    holdout: list[Recording]
    gantry_training: list[Recording]
    gantry_holdout: list[Recording]


def split_data(recordings: Sequence[Recording], heldout: Sequence[Recording]) -> DataSplit:
    """The recordings `heldout` prove or, where there are none, parts of the others."""
    if heldout:
        return DataSplit(list(recordings), list(heldout), list(recordings), list(heldout))
    segments = [segment(one) for one in recordings]
    of_row, met = _launches(recordings, segments)
    chosen = _every(SPLIT.launches, met)
    shows = [np.isin(rows, chosen) for rows in of_row]
    paths = [_path_that_proves(*each) for each in zip(recordings, of_row, shows, strict=True)]
    return DataSplit(
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
    block = min(SPLIT.longest_block, float(t[-1] - t[0]) / SPLIT.fewest_blocks) or SPLIT.longest_block
    return ((t - t[0]) // block).astype(int) % SPLIT.launches == SPLIT.launches - 1


def launches_of(recordings: Sequence[Recording], segments: Sequence[Segments]) -> tuple[np.ndarray, ...]:
    """For each recording, the number (frames,) of the launch of each row of its frames, counted through all of them."""
    return _launches(recordings, segments)[0]


def _launches(
    recordings: Sequence[Recording], segments: Sequence[Segments]
) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
    """The number of each row's launch, for each recording, and how many contacts each launch (launches, KINDS) has."""
    of_row, first, met = [], 0, []
    for recording, some in zip(recordings, segments, strict=True):
        part = _launched(recording, some, 0.0)
        _, opening = np.unique(part.cluster, return_index=True)
        begun = _rows(recording, part)[opening]
        frames = 0 if recording.frames is None else recording.frames.rows
        of_row.append(first + np.maximum(np.searchsorted(begun, np.arange(frames), side="right") - 1, 0))
        first += max(part.clusters, 1)
        met.append(_met(some, part))
    return tuple(of_row), np.concatenate(met)


def _met(segments: Segments, part: GlideData) -> np.ndarray:
    """How many contacts of each kind each launch (launches, KINDS) has between two glides."""
    met = np.zeros((max(part.clusters, 1), len(KINDS)), int)
    begin, finish = part.t[part.first[:-1]], part.t[part.first[1:] - 1]
    for k, contact in enumerate(segments.contacts):
        before = glide_before(segments, begin, finish, k)
        if before is not None and contact.where in KINDS:
            met[part.cluster[before + 1], KINDS.index(contact.where)] += 1
    return met


def _every(step: int, met: np.ndarray) -> np.ndarray:
    """The launches of the holdout, by number: one of each `step` launches, or one of fewer. `met` (launches, KINDS):
    how many contacts each has.

    It is the last of them that leaves the others `SPLIT.fewest_contacts` of each kind, where there are so many. Where
    none of the chosen met any wall, or the robot, one that did takes the place of one that is not missed.
    """
    ends = range(step, len(met) + 1, step) if len(met) >= step else [len(met)] * (len(met) > 1)
    chosen, left = [], met.sum(axis=0)
    for end in ends:
        some = range(end - 1, max(end - step, 0) - 1, -1)
        k = next(
            (
                k
                for k in some
                if np.all((left - met[k] >= SPLIT.fewest_contacts) | (met[k] == 0) | (left < SPLIT.fewest_contacts))
            ),
            end - 1,
        )
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


def glides_of(recording: Recording, segments: Segments) -> GlideData:
    """The glides of a recording, with what its calibration says that it errs by."""
    return _launched(recording, segments, stated_map_error(recording))


def _launched(recording: Recording, segments: Segments, stated: float) -> GlideData:
    t = np.zeros(0) if recording.frames is None else recording.frames.t
    return glide_data(segments, geometry(recording), mallet_tracks(recording, t), stated)


def _rows(recording: Recording, part: GlideData) -> np.ndarray:
    """The row (glides,) of the frames at which each glide begins."""
    if recording.frames is None:
        return np.zeros(0, int)
    return np.searchsorted(recording.frames.t, part.t[part.first[:-1]])
