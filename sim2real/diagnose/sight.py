"""What the sensor of a recording was like, in numbers that a report shows."""

from __future__ import annotations

import numpy as np

from sim2real.diagnose.finding import Sight
from sim2real.diagnose.glide.data import GlideData
from sim2real.diagnose.pieces import Pieces
from sim2real.recording import Recording


def sight(recording: Recording, pieces: Pieces, glides: GlideData) -> Sight:
    """The sensor in one recording, with its `glides`; a recording without frames has none of them."""
    frames = recording.frames
    t = np.zeros(0) if frames is None else frames.t
    unseen = np.zeros(0, bool) if frames is None else ~np.isfinite(frames["puck_x"] + frames["puck_y"])
    dropped, held, wild = (float(which.mean()) if len(which) else 0.0 for which in (unseen, pieces.held, pieces.wild))
    (memory,), (place_std,) = glides.memories, glides.place_std
    return Sight(
        recording.name, float(np.ptp(t)) if len(t) else 0.0, len(t), pieces.noise.position, pieces.noise.clock,
        memory.time if memory.share else 0.0, place_std, dropped, held, wild, len(pieces.launches),
        len(pieces.glides), len(pieces.hits), len(pieces.of_kind("unexplained")), recording.notes,
    )  # fmt: skip
