"""The summary of a recording's sensor for the report."""

from __future__ import annotations

import numpy as np

from sim2real.diagnose.regimes.sliding.data import GlideData
from sim2real.diagnose.result.result import SensorSummary
from sim2real.recording.folder import Recording
from sim2real.segmentation.segments import Segments


def sensor_summary(recording: Recording, segments: Segments, glides: GlideData) -> SensorSummary:
    """Return the summary of the sensor in one recording with its `glides`, which are empty without frames."""
    frames = recording.frames
    t = np.zeros(0) if frames is None else frames.t
    unseen = np.zeros(0, bool) if frames is None else ~np.isfinite(frames["puck_x"] + frames["puck_y"])
    dropped, repeated, outliers = (
        float(which.mean()) if len(which) else 0.0 for which in (unseen, segments.held, segments.wild)
    )
    (noise,) = glides.noise
    correlated = noise.autocorrelation
    return SensorSummary(
        recording.name, float(np.ptp(t)) if len(t) else 0.0, len(t), segments.noise.position, segments.noise.clock,
        correlated.time if correlated.share else 0.0, noise.map_error_std, dropped, repeated, outliers,
        len(segments.launches), len(segments.glides), len(segments.contacts), len(segments.of_kind("unexplained")),
        recording.notes,
    )  # fmt: skip
