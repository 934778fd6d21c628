"""A recording as an exact camera would have seen it: the map and the clock that were found, undone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sim2real.diagnose.sensing.clock import EXACT, Clock
from sim2real.recording import Recording, Stream

PLACES = (("puck_x", "puck_y"), ("opponent_x", "opponent_y"))


def corrected(recording: Recording, scale: np.ndarray, clock: Clock = EXACT) -> Recording:
    """`recording` with the frames' places freed of `scale` (3,), as in `scale.NAMES`, and their stamps of `clock`."""
    if recording.frames is None:
        return recording
    columns = dict(recording.frames.columns)
    for x, y in PLACES:
        columns[y] = columns[y] / (1 + scale[1])
        columns[x] = (columns[x] - scale[2] * columns[y]) / (1 + scale[0])
    columns["t"] = np.asarray(clock.encoder_time(columns["t"]))
    return replace(recording, frames=Stream(columns))
