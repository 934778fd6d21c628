"""The split of recordings into training data and holdout.

The holdout is taken out before any identification. It consists of whole recordings (`--holdout`) or, if none are given,
of whole launches of the puck together with the gantry's motion during them (blocks of seconds where no puck was
launched). No fit, choice or correction uses it: `identify` gets the training data alone, on which laws are selected by
cross-validation over launches (`engine.cross_validation`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from sim2real.diagnose.regimes.contact.motion import glide_before
from sim2real.diagnose.regimes.sliding.data import GlideData, SmoothGlides, glide_data, smooth_glides
from sim2real.diagnose.sensor_noise.model import stated_map_error
from sim2real.diagnose.tuned import SPLIT
from sim2real.recording.folder import Recording, Stream
from sim2real.segmentation.causes import WALLS, geometry, mallet_tracks
from sim2real.segmentation.segments import Segments, segment

# Kinds of contacts; "nothing near": a wall contact of a table whose stated size is wrong
KINDS = (*WALLS, "nothing near", "robot")


class DataSplit(NamedTuple):
    """Training data and holdout, split by the puck's frames and, for the gantry, by the mallet's path.

    Each split affects one stream alone. The mallet's path is an input of the puck's regimes, not what they predict, and
    stays complete there. The launches are found, and their contacts counted, in the complete recordings: the cut needs
    them.
    """

    training: list[Recording]
    holdout: list[Recording]
    gantry_training: list[Recording]
    gantry_holdout: list[Recording]


def split_data(recordings: Sequence[Recording], heldout: Sequence[Recording]) -> DataSplit:
    """Split `recordings`; the holdout is `heldout` or, if there are none, about one of `SPLIT.launches` launches."""
    if heldout:
        return DataSplit(list(recordings), list(heldout), list(recordings), list(heldout))
    segments = [segment(one) for one in recordings]
    launch_of_row, contacts = _launches(recordings, segments)
    chosen = _choose_holdout(SPLIT.launches, contacts)
    frames = [np.isin(launches, chosen) for launches in launch_of_row]
    paths = [_holdout_of_path(*each) for each in zip(recordings, launch_of_row, frames, strict=True)]
    return DataSplit(
        [_only(one, "frames", ~rows) for one, rows in zip(recordings, frames, strict=True)],
        [_only(one, "frames", rows) for one, rows in zip(recordings, frames, strict=True)],
        [_only(one, "mallet", ~rows) for one, rows in zip(recordings, paths, strict=True)],
        [_only(one, "mallet", rows) for one, rows in zip(recordings, paths, strict=True)],
    )


def _only(one: Recording, stream: str, rows: np.ndarray) -> Recording:
    """Return a recording with only the `rows` (n,) bool of one stream."""
    complete = getattr(one, stream)
    if complete is None:
        return one
    kept: dict[str, Any] = {stream: Stream({name: column[rows] for name, column in complete.columns.items()})}
    return replace(one, **kept)


def _holdout_of_path(one: Recording, launch_of_row: np.ndarray, frames: np.ndarray) -> np.ndarray:
    """Return which rows (n,) bool of the mallet's path are in the holdout.

    These are the rows during the holdout's `frames` (frames,) bool, so that the training data contain no part of its
    mallet contacts, or blocks of seconds if no frame is in the holdout.
    """
    if one.mallet is None or not one.mallet.rows:
        return np.zeros(0, bool)
    t = one.mallet.t
    if frames.any():
        assert one.frames is not None
        return frames[np.clip(np.searchsorted(one.frames.t, t, side="right") - 1, 0, len(launch_of_row) - 1)]
    block = min(SPLIT.longest_block, float(t[-1] - t[0]) / SPLIT.fewest_blocks) or SPLIT.longest_block
    return ((t - t[0]) // block).astype(int) % SPLIT.launches == SPLIT.launches - 1


def launches_of(recordings: Sequence[Recording], segments: Sequence[Segments]) -> tuple[np.ndarray, ...]:
    """Return, for each recording, the launch number (frames,) of each frame, counted through all recordings."""
    return _launches(recordings, segments)[0]


def _launches(
    recordings: Sequence[Recording], segments: Sequence[Segments]
) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
    """Return the launch number of each frame, for each recording, and the contact counts (launches, KINDS)."""
    launch_of_row, first, counts = [], 0, []
    for recording, own_segments in zip(recordings, segments, strict=True):
        t = _frame_times(recording)
        found = smooth_glides(own_segments, geometry(recording), mallet_tracks(recording, t))
        _, first_glide = np.unique(found.cluster, return_index=True)
        starts = np.searchsorted(t, [found.glides[k].t[0] for k in first_glide])
        launch_of_row.append(first + np.maximum(np.searchsorted(starts, np.arange(len(t)), side="right") - 1, 0))
        counts.append(_contact_counts(own_segments, found) if len(t) else np.zeros((0, len(KINDS)), int))
        first += len(counts[-1])
    return tuple(launch_of_row), np.concatenate(counts)


def _contact_counts(segments: Segments, found: SmoothGlides) -> np.ndarray:
    """Return the number of contacts of each kind between two glides of each launch (launches, KINDS)."""
    counts = np.zeros((int(found.cluster.max(initial=0)) + 1, len(KINDS)), int)
    begin, finish = (np.array([one.t[end] for one in found.glides]) for end in (0, -1))
    for k, contact in enumerate(segments.contacts):
        before = glide_before(segments, begin, finish, k)
        if before is not None and contact.where in KINDS:
            counts[found.cluster[before + 1], KINDS.index(contact.where)] += 1
    return counts


def _choose_holdout(step: int, counts: np.ndarray) -> np.ndarray:
    """Return the launches of the holdout, by number: one of every `step` launches, or one if there are fewer.

    `counts` (launches, KINDS): contacts of each launch. Of every `step` launches the last is chosen that leaves
    `SPLIT.fewest_contacts` contacts of each kind to the training data, as far as these exist. If no chosen launch has a
    wall contact, or none has a robot contact, one that has replaces the chosen launch with the least information.
    """
    ends = range(step, len(counts) + 1, step) if len(counts) >= step else [len(counts)] * (len(counts) > 1)
    chosen, training = [], counts.sum(axis=0)
    fewest = SPLIT.fewest_contacts
    for end in ends:
        candidates = range(end - 1, max(end - step, 0) - 1, -1)
        k = next(
            (
                k
                for k in candidates
                if np.all((training - counts[k] >= fewest) | (counts[k] == 0) | (training < fewest))
            ),
            end - 1,
        )
        chosen.append(k)
        training = training - counts[k]
    wall_and_robot = np.stack([counts[:, :-1].sum(axis=1), counts[:, -1]], axis=1)
    for kind in range(wall_and_robot.shape[1]):
        others = [k for k in np.flatnonzero(wall_and_robot[:, kind]) if k not in chosen]
        if not chosen or not others or wall_and_robot[chosen, kind].any():
            continue
        spare = min(chosen, key=lambda k: _information(wall_and_robot, [one for one in chosen if one != k], k))
        chosen[chosen.index(spare)] = int(others[len(others) // 2])
    return np.array(sorted(chosen), int)


def _information(counts: np.ndarray, rest: list[int], k: int) -> tuple[int, int]:
    """Return how many kinds of contacts launch `k` has that the launches `rest` lack, and how many contacts it has."""
    alone = (counts[k] > 0) & ~counts[rest].any(axis=0)
    return int(alone.sum()), int(counts[k].sum())


def glides_of(recording: Recording, segments: Segments) -> GlideData:
    """Return the glides of a recording, with the position error that its calibration states."""
    tracks = mallet_tracks(recording, _frame_times(recording))
    return glide_data(segments, geometry(recording), tracks, stated_map_error(recording))


def _frame_times(recording: Recording) -> np.ndarray:
    """Return the times (frames,) [s] of the frames."""
    return np.zeros(0) if recording.frames is None else recording.frames.t
