"""Launches kept apart: no fit sees them, not even the sensing's; they serve the proof alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.contacts import geometry, mallet_tracks
from sim2real.diagnose.glide.data import GlideData, glide_data
from sim2real.diagnose.pieces import Pieces
from sim2real.recording import Recording

KEPT_APART = 4  # every so manieth launch serves the proof alone


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
    """The launches of the last `heldout` recordings, or every KEPT_APART-th where there are none."""
    of_row, first = [], [0]
    for recording, some in zip(recordings, pieces, strict=True):
        part = glides_of(recording, some)
        _, opening = np.unique(part.cluster, return_index=True)
        begun = _rows(recording, part)[opening]
        frames = 0 if recording.frames is None else recording.frames.rows
        of_row.append(first[-1] + np.maximum(np.searchsorted(begun, np.arange(frames), side="right") - 1, 0))
        first.append(first[-1] + max(part.clusters, 1))
    numbers = np.arange(first[-1])
    apart = numbers[first[len(recordings) - heldout] :] if heldout else numbers[KEPT_APART - 1 :: KEPT_APART]
    return Launches(tuple(of_row), apart, bool(heldout))


def glides_of(recording: Recording, pieces: Pieces) -> GlideData:
    """The glides of a recording."""
    t = np.zeros(0) if recording.frames is None else recording.frames.t
    return glide_data(pieces, geometry(recording), mallet_tracks(recording, t))


def _rows(recording: Recording, part: GlideData) -> np.ndarray:
    """The row (glides,) of the frames at which each glide begins."""
    if recording.frames is None:
        return np.zeros(0, int)
    return np.searchsorted(recording.frames.t, part.t[part.first[:-1]])
