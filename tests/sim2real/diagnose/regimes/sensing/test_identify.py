"""Late stamps, a drifting clock, a stretched map and held frames, added to recordings of an independent table."""

from dataclasses import replace

import numpy as np
import pytest

from sim2real.diagnose.regimes.sensing.clock import Clock
from sim2real.diagnose.regimes.sensing.identify import corrected, identify_sensing, prove_sensing
from sim2real.diagnose.split import launches_of
from sim2real.recording.folder import Recording, Stream, read_recording
from sim2real.segmentation.segments import segment
from sim2real.study.independent_table import Law
from sim2real.study.independent_table.recorder.camera import Camera
from sim2real.study.independent_table.recorder.record import make_recording


def recorded(folder, law: Law, scenario: str, seed: int, seconds: float, camera: Camera | None = None) -> Recording:
    make_recording(folder, law, scenario, seed, seconds, camera, dt=5e-5)
    return read_recording(folder)


def diagnosed(recording: Recording):
    """The result of the sensing, and its parameters by label."""
    segments = [segment(recording)]
    launch = launches_of([recording], segments)
    result = prove_sensing(identify_sensing([recording], segments, launch), [recording], segments, launch)
    return result, {label: one for finding in result.findings for label, one in finding.parameters.items()}


@pytest.fixture(scope="module")
def rally(tmp_path_factory) -> Recording:
    return recorded(tmp_path_factory.mktemp("rally"), Law(), "rally", 1, 45.0)


def restamped(recording: Recording, stamps) -> Recording:
    assert recording.frames is not None
    return replace(recording, frames=Stream({**recording.frames.columns, "t": stamps(recording.frames.t)}))


def test_an_exact_camera_has_no_finding(rally):
    result, _ = diagnosed(rally)
    assert result.findings == () and result.undetermined == "" and result.defaults


@pytest.mark.parametrize("delay", [0.009, 0.03])
def test_a_delay_is_measured(rally, delay):
    result, numbers = diagnosed(restamped(rally, lambda t: t + delay))
    assert [one.mechanism for one in result.findings] == ["camera_delay"]
    assert numbers["delay_s"].value == pytest.approx(delay, abs=0.0005)
    assert numbers["delay_s"].low < delay < numbers["delay_s"].high
    assert result.proof is not None and result.proof.after_m < 0.2 * result.proof.before_m


def test_a_drift_is_no_delay(rally):
    result, numbers = diagnosed(restamped(rally, lambda t: t * (1 + 2e-4)))
    assert [one.mechanism for one in result.findings] == ["clock_drift"]
    assert numbers["ppm"].value == pytest.approx(200.0, rel=0.1)
    assert result.findings[0].where == {"stream": "frames"}


def test_without_a_mallet_no_clock_is_named(tmp_path):
    result, _ = diagnosed(recorded(tmp_path, Law(camera_delay=0.03), "launches", 3, 15.0))
    assert result.findings == ()


def test_a_stretched_map_is_measured_and_a_wrong_size_refused(tmp_path):
    clean = recorded(tmp_path, Law(), "launches", 5, 60.0)
    assert clean.frames is not None
    x, y = clean.frames["puck_x"], clean.frames["puck_y"]

    def mapped(scale_x: float, scale_y: float, shear: float) -> Recording:
        seen = {"puck_x": (1 + scale_x) * x + shear * y, "puck_y": (1 + scale_y) * y}
        return replace(clean, frames=Stream({**clean.frames.columns, **seen}))  # type: ignore[union-attr] - these recordings hold frames

    result, numbers = diagnosed(mapped(0.006, -0.008, 0.005))
    assert [one.mechanism for one in result.findings] == ["scale_error"]
    for label, truth in (("scale_x", 0.006), ("scale_y", -0.008), ("shear", 0.005)):
        assert numbers[label].low < truth < numbers[label].high
        assert numbers[label].value == pytest.approx(truth, abs=0.001)
    wrong, _ = diagnosed(mapped(0.03, 0.03, 0.0))
    assert wrong.findings == () and "stated length" in wrong.undetermined


def test_held_frames_are_counted_and_the_others_are_exact(tmp_path):
    recording = recorded(tmp_path, Law(), "launches", 6, 30.0, Camera(held=0.03, dropped=0.02))
    result, numbers = diagnosed(recording)
    assert [one.mechanism for one in result.findings] == ["held_frames"]
    assert numbers["fraction"].low < 0.03 < numbers["fraction"].high
    (found,) = result.findings
    assert result.proof is not None and 2 <= result.proof.pieces < 10  # launches, not frames
    assert found.before is not None and found.after is not None
    assert found.before > 1.2 * found.after and 0.9 < found.after < 1.1
    assert result.proof.floor_m == pytest.approx(0.0005 * np.sqrt(2 * 1.5), rel=0.15)  # of the mean of two neighbours


def sensed(recording: Recording):
    segments = [segment(recording)]
    return identify_sensing([recording], segments, launches_of([recording], segments))


@pytest.mark.slow
def test_a_map_that_is_wrong_in_one_recording_alone_does_not_help_in_another(tmp_path):
    clean = recorded(tmp_path, Law(), "launches", 5, 60.0)
    assert clean.frames is not None
    spoilt = replace(clean, frames=Stream({**clean.frames.columns, "puck_y": clean.frames["puck_y"] * 1.012}))
    found = sensed(spoilt)
    assert [one.mechanism for one in found.regime_result.findings] == ["scale_error"]
    mended = found.correct(spoilt)
    assert mended.frames is not None
    np.testing.assert_allclose(mended.frames["puck_y"], clean.frames["puck_y"], atol=0.0004)
    for holdout, better in ((spoilt, True), (clean, False)):
        segments = [segment(holdout)]
        proof = prove_sensing(found, [holdout], segments, launches_of([holdout], segments)).proof
        assert proof is not None and (proof.after_m < 0.3 * proof.before_m) == better


@pytest.mark.slow
def test_recordings_held_out_prove_a_clock(rally):
    late = restamped(rally, lambda t: t + 0.02)
    found = sensed(late)
    for holdout, better in ((late, True), (rally, False)):
        segments = [segment(holdout)]
        of_row = launches_of([holdout], segments)
        proof = prove_sensing(found, [holdout], segments, of_row).proof
        assert proof is not None and (proof.after_m < 0.2 * proof.before_m) == better
        assert proof.pieces <= len(np.unique(of_row[0]))


def test_a_known_clock_is_corrected_exactly(rally):
    assert rally.frames is not None
    spoilt = restamped(rally, lambda t: (t + 0.02) * (1 + 1e-4))
    all_values = corrected(spoilt, np.zeros(3), Clock(0.02, 1e-4, np.zeros((2, 2))))
    assert all_values.frames is not None
    np.testing.assert_allclose(all_values.frames.t, rally.frames.t, atol=1e-9)
