"""Tables recorded by a simulated camera: no finding where nothing is missing, in spite of calibration errors, and the
right one otherwise."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from puckpilot_env.parameters import TABLE
from sim2real.diagnose.pipeline import Diagnosis, diagnose
from sim2real.recording.folder import read_recording
from sim2real.study.independent_table.cases import FILM, draw_case
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.recorder.record import make_recording

pytestmark = pytest.mark.slow

DEFAULTS = {row.name: row.default for row in TABLE}
SECONDS = 30.0


def diagnosed(folder: Path, law: Law, scenario: str, seed: int, stated: bool = True) -> Diagnosis:
    make_recording(folder / "film", law, scenario, seed, SECONDS, replace(FILM, calibration=seed), dt=5e-5)
    recording = read_recording(folder / "film")
    if not stated:
        camera = {**recording.meta["camera"], "place_std_m": None}
        recording = replace(recording, meta={**recording.meta, "camera": camera})
    return diagnose([recording], [], DEFAULTS, lambda *_: None)


@pytest.mark.parametrize(("scenario", "seed"), [("launches", 1), pytest.param("rally", 2, marks=pytest.mark.long)])
def test_nothing_is_missing(tmp_path: Path, scenario: str, seed: int) -> None:
    found = diagnosed(tmp_path, Law(), scenario, seed)
    assert found.verdict == "agrees" and not found.findings and not any(one.misfit for one in found.regime_results)
    (sensor_summary,) = found.sensor_summaries
    assert 0.005 < sensor_summary.correlation_time_s < 0.03 and sensor_summary.place_std_m == 1.8e-4


@pytest.mark.long
def test_an_unstated_calibration_error_is_taken_for_physics(tmp_path: Path) -> None:
    """The control: the same recording without the stated error."""
    found = diagnosed(tmp_path, Law(), "launches", 1, stated=False)
    assert found.verdict != "agrees"


@pytest.mark.parametrize(
    ("law", "mechanism", "name"),
    [
        (Law(tilt_x=0.015, tilt_y=-0.008), "table_tilt", "tilt_x"),
        pytest.param(Law(warp_xx=0.03, warp_yy=-0.02, warp_xy=0.01), "table_warp", "warp_xx", marks=pytest.mark.long),
    ],
)
def test_what_is_missing_is_named(tmp_path: Path, law: Law, mechanism: str, name: str) -> None:
    found = diagnosed(tmp_path, law, "launches", 4)
    assert [one.mechanism for one in found.findings] == [mechanism]
    estimate = found.findings[0].parameters[name]
    assert estimate.low < getattr(law, name) < estimate.high
    (one, *_) = found.findings
    assert one.before is not None and one.after is not None and one.after < min(1.3, one.before)


def test_errors_of_the_holdout_do_not_affect_the_fit(tmp_path: Path) -> None:
    """The same recording with two holdouts gives the same parameters."""
    names = ("fitted", "proof", "another")
    for seed, name in enumerate(names, 1):
        make_recording(tmp_path / name, Law(), "launches", seed, 15.0, replace(FILM, calibration=7), dt=5e-5)
    fitted, *proofs = (read_recording(tmp_path / name) for name in names)
    baselines = []
    for proof in proofs:
        (glide,) = (
            one
            for one in diagnose([fitted], [proof], DEFAULTS, lambda *_: None).regime_results
            if one.regime == "glide"
        )
        baselines.append([glide.baseline[name].value for name in ("friction", "drag")])
    assert baselines[0] == pytest.approx(baselines[1], rel=1e-6)


def test_autocorrelated_noise_of_an_uncalibrated_camera_is_no_physics(tmp_path: Path) -> None:
    """Noise of consecutive frames correlates by 0.6 (AR(1)); taken for white noise, contacts would not fit it."""
    case = draw_case(901, 1, "disturbed")
    assert case.truth["disturbance"] == "autocorrelated noise" and not case.camera.place_error
    make_recording(tmp_path / "noisy", case.law, case.scenario, 3, SECONDS, case.camera, dt=5e-5)
    found = diagnose([read_recording(tmp_path / "noisy")], [], DEFAULTS, lambda *_: None)
    assert found.verdict == "agrees" and not any(one.misfit for one in found.regime_results)
