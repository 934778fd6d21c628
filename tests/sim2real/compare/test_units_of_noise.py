"""Errors in units of the noise: about 1 if the table obeys the simulator's law, far above 1 with effects."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim2real.compare.predict import compare_segments
from sim2real.compare.summary import summarize
from sim2real.recording.folder import Recording, read_recording
from sim2real.recording.stream_csv import Stream
from sim2real.recording.table_parameters import parameters
from sim2real.segmentation.segments import segment
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.recorder.camera import Camera
from sim2real.study.independent_table.recorder.record import make_recording
from tests.places import PRACTICE

LARGEST = 2.0
PRACTICE_RESTITUTION = {"wall_restitution": 0.8, "mallet_restitution": 0.8}


def compared(recording: Recording, **values: float) -> dict[str, Any]:
    """The summary of a comparison with these values of parameters."""
    segments, every = segment(recording), parameters(recording) | values
    return summarize(recording, segments, compare_segments(recording, segments, every), every)


def made(folder: Path, law: Law, scenario: str, camera: Camera, seconds: float = 40.0) -> Recording:
    """A recording of the independent table."""
    make_recording(folder / "made", law, scenario, 5, seconds, camera, encoder_rate=200.0, dt=5e-5)
    return read_recording(folder / "made")


def practice(name: str) -> Recording:
    if not PRACTICE.is_dir():
        pytest.skip(f"the practice recordings are not beside this checkout ({PRACTICE})")
    return read_recording(PRACTICE / name)


@pytest.mark.slow
@pytest.mark.parametrize("noise", [0.0005, 0.00003])
def test_nothing_stands_out_in_a_match_without_effects(tmp_path: Path, noise: float) -> None:
    """Both mallets, one by encoders, one by the camera: a precise camera shows how uncertain their velocities are."""
    recording = made(tmp_path, Law(), "match", Camera(noise=noise, jitter=0.0))
    summary = compared(recording)
    for kind, fewest in (("glide", 30), ("wall", 20), ("mallet", 20)):
        assert summary[kind]["pieces"] > fewest
        assert 0.5 < summary[kind]["times_noise"]["median"] < 1.5
    for kind in ("wall", "mallet"):
        assert summary[kind]["times_noise"]["high"] < 2 * LARGEST
    assert str(summary["part_most"]).startswith("none beyond noise")


def test_a_calibration_that_states_its_error_stands_out_in_nothing(tmp_path: Path) -> None:
    recording = made(tmp_path, Law(), "launches", Camera(noise=0.00003, jitter=0.0, place_error=0.0003), 60.0)
    summary = compared(recording)
    assert all(summary[kind]["times_noise"]["median"] < 1.5 for kind in ("glide", "wall"))
    assert recording.nominal("camera", "place_std_m") == 0.0003


def test_noise_that_is_correlated_from_frame_to_frame_stands_out_in_nothing(tmp_path: Path) -> None:
    """An AR(1) correlation of 0.6 at 120 Hz; white noise of the same size would explain half of these errors."""
    camera = Camera(noise=0.0005, jitter=0.0, correlation_time=0.0163, correlated=1.0)
    summary = compared(made(tmp_path, Law(), "launches", camera, 60.0))
    assert all(0.5 < summary[kind]["times_noise"]["median"] < 1.5 for kind in ("glide", "wall"))


def test_a_practice_recording_without_effects_is_explained() -> None:
    summary = compared(practice("null"), **PRACTICE_RESTITUTION)
    assert summary["wall"]["times_noise"]["median"] < 1.5 and summary["wall"]["times_noise"]["high"] < LARGEST + 0.5


@pytest.mark.parametrize("name", [pytest.param("wall_spin", marks=pytest.mark.long), "restitution_speed"])
def test_an_effect_at_the_walls_of_a_practice_recording_stands_out(name: str) -> None:
    summary = compared(practice(name), **PRACTICE_RESTITUTION)
    assert summary["wall"]["times_noise"]["median"] > 3.0 and summary["glide"]["times_noise"]["median"] < 1.2
    assert str(summary["part_most"]).startswith("wall contacts")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "kind"),
    [
        (Law(wall_spin=True), "wall"),
        pytest.param(Law(restitution_slope=0.08), "wall", marks=pytest.mark.long),
        (Law(mallet_restitution=0.5), "mallet"),
        pytest.param(Law(mallet_mu=0.3), "mallet", marks=pytest.mark.long),
    ],
)
def test_an_effect_stands_out_where_it_is(tmp_path: Path, law: Law, kind: str) -> None:
    summary = compared(made(tmp_path, law, "match", Camera(noise=0.0002, jitter=0.0)))
    assert summary[kind]["times_noise"]["median"] > LARGEST
    assert str(summary["part_most"]).startswith(kind)


@pytest.mark.parametrize("share", [0.0, 0.05])
def test_a_resting_puck_repeats_no_frames(tmp_path: Path, share: float) -> None:
    """A still puck seen without noise has equal positions, which says nothing of the camera."""
    recording = made(tmp_path, Law(), "launches", Camera(noise=0.0003, jitter=0.0, held=share), 30.0)
    assert recording.frames is not None
    frames = recording.frames
    moving = np.hypot(np.gradient(frames["puck_x"], frames.t), np.gradient(frames["puck_y"], frames.t)) > 0.2
    seen = np.flatnonzero(np.isfinite(frames["puck_x"]))[-1]
    rest = {name: np.full(240, frames[name][seen]) for name in frames} | {"t": frames.t[-1] + np.arange(1, 241) / 120}
    at_rest = Stream({name: np.append(frames[name], rest[name]) for name in frames})
    held = compared(replace(recording, frames=at_rest))["sensor"]["held"]
    assert held == pytest.approx(share * moving.sum(), rel=0.25)
