"""The share of repeated frames, of pucks that end slowly too."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sim2real.diagnose.regimes.sensing.repeated_frames import moving_frames
from sim2real.recording.folder import read_recording
from sim2real.segmentation.segments import segment
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.recorder.camera import Camera
from sim2real.study.independent_table.recorder.record import make_recording


@pytest.mark.slow
def test_the_share_is_that_of_the_camera(tmp_path: Path) -> None:
    share = 0.3
    camera = Camera(noise=0.001, rate=200.0, held=share)
    make_recording(tmp_path / "table", Law(friction=0.3), "launches", 11, 60.0, camera, dt=5e-5)
    recording = read_recording(tmp_path / "table")
    assert recording.frames is not None
    found = moving_frames(recording, segment(recording), np.zeros(recording.frames.rows, int))
    deviation = np.sqrt(share * (1.0 - share) / len(found.held))
    assert len(found.held) > 1500
    assert found.held.mean() == pytest.approx(share, abs=3.5 * deviation)
