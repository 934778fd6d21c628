"""A diagnosis of recordings whose truth an independent table knows: findings, none, or undetermined."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from puckpilot import main
from puckpilot_env.options.effects_file import effect_values
from sim2real.diagnose.identify_regime import identify_regime
from sim2real.diagnose.pipeline import diagnose
from sim2real.diagnose.report.summary import summary
from sim2real.recording.folder import Stream, read_recording
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.recorder.camera import Camera
from sim2real.study.independent_table.recorder.record import make_recording
from tests.places import PRACTICE
from tests.sim2real.diagnose.engine.linear_problem import LAUNCHES, NO_EVIDENCE, LinearProblem, LinearRegime
from tests.sim2real.diagnose.well_formed import faults

NOISE = Camera(noise=0.0006, rate=150.0)
SECONDS = 40.0
LONG_PRACTICE = ("tilt", "other_parameters", "restitution_speed", "unlisted_vortex")


def _diagnosis(folder: Path, law: Law, seconds: float = SECONDS, seed: int = 5, scenario: str = "launches"):
    make_recording(folder, law, scenario, seed, seconds, camera=NOISE, dt=5e-5)
    return diagnose([read_recording(folder)], [], {}, lambda stage, share: None)


@pytest.mark.slow
def test_no_finding_where_nothing_is_missing(tmp_path):
    found = _diagnosis(tmp_path, Law())
    assert (found.verdict, found.findings) == ("agrees", [])


@pytest.mark.slow
def test_other_parameters_are_no_missing_physics(tmp_path):
    found = _diagnosis(tmp_path, Law(friction=0.06, drag=0.05, wall_restitution=0.88))
    assert (found.verdict, found.findings) == ("parameters_only", [])
    glide = next(each for each in found.regime_results if each.regime == "glide")
    assert glide.baseline["friction"].low < 0.06 < glide.baseline["friction"].high


@pytest.mark.slow
@pytest.mark.parametrize(
    "law, name, parameter, value",
    [
        pytest.param(Law(tilt_x=0.015, tilt_y=-0.01), "table_tilt", "tilt_x", 0.015, marks=pytest.mark.long),
        pytest.param(Law(linear_drag=0.06), "linear_drag", "k", 0.06, marks=pytest.mark.long),
        pytest.param(
            Law(restitution_slope=0.05, wall_restitution=0.85),
            "speed_dependent_restitution",
            "slope",
            0.05,
            marks=pytest.mark.long,
        ),
        (Law(wall_spin=True, wall_mu=0.15), "wall_friction_spin", "mu", 0.15),
    ],
)
def test_one_effect_is_named_and_measured(tmp_path, law, name, parameter, value):
    found = _diagnosis(tmp_path, law)
    assert [one.mechanism for one in found.findings] == [name]
    estimate = found.findings[0].parameters[parameter]
    assert estimate.value == pytest.approx(value, rel=0.05)
    assert estimate.low < estimate.high
    proof = found.proof
    assert proof is not None and proof.floor_m is not None
    excess = proof.before_m**2 - proof.floor_m**2
    assert excess > 0.0 and proof.after_m**2 < proof.floor_m**2 + 0.1 * excess


def test_too_little_data_is_undetermined_and_says_so(tmp_path):
    found = _diagnosis(tmp_path, Law(tilt_x=0.02), seconds=3.0)
    assert found.verdict == "undetermined"
    assert "too little data" in summary(found, [])[0]


@pytest.mark.slow
def test_the_command_writes_files_that_others_read(tmp_path, capsys):
    make_recording(tmp_path / "table", Law(tilt_x=0.02), "launches", 3, SECONDS, camera=NOISE, dt=5e-5)
    assert main(["diagnose", str(tmp_path / "table"), "--out", str(tmp_path / "out"), "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed == json.loads((tmp_path / "out" / "diagnosis.json").read_text())
    assert printed["findings"][0]["mechanism"] == "table_tilt"
    values = effect_values(tmp_path / "out" / "effects.toml")
    assert values["tilt_x"] == pytest.approx(0.02, rel=0.05)
    assert faults(printed) == []


@pytest.mark.parametrize(
    "words, expected",
    [(["/no/such/place"], "no/such"), (["."], "meta.json")],
)
def test_what_is_no_recording_gets_one_line(words, expected, tmp_path, capsys):
    assert main(["diagnose", *words, "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert expected in error and error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_folder_that_cannot_be_written_to_is_reported_before_the_work(tmp_path, capsys, monkeypatch):
    make_recording(tmp_path / "table", Law(), "launches", 3, 3.0, camera=NOISE)
    (tmp_path / "file").write_text("")
    monkeypatch.setattr("sim2real.diagnose.pipeline.diagnose", lambda *_: pytest.fail("diagnosed"))
    for place in (tmp_path / "file", tmp_path / "file" / "below", Path("/proc/none")):
        assert main(["diagnose", str(tmp_path / "table"), "--out", str(place)]) == 2
        error = capsys.readouterr().err
        assert f"cannot write to '{place}'" in error and error.count("\n") == 1


@pytest.mark.parametrize("words", [["a", "../here/a"], ["a", "--holdout", "a"]])
def test_a_folder_given_twice_proves_nothing(words, tmp_path, monkeypatch, capsys):
    (tmp_path / "here" / "a").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "here")
    assert main(["diagnose", *words, "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert "is given twice" in error and error.count("\n") == 1


def test_a_copy_of_a_recording_proves_nothing(tmp_path, capsys):
    for name in ("a", "copy"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "frames.csv").write_text("t,puck_x,puck_y\n0,1,0.5\n")
    words = [str(tmp_path / "a"), "--holdout", str(tmp_path / "copy"), "--out", str(tmp_path / "out")]
    assert main(["diagnose", *words]) == 2
    assert f"is given twice (it holds the same as {tmp_path / 'a'})" in capsys.readouterr().err


@pytest.mark.slow
def test_the_clock_s_zero_does_not_matter(tmp_path):
    """Stamps of a day's clock, as many loggers write them: the same delay of the camera as with stamps from zero."""
    make_recording(tmp_path / "rally", Law(camera_delay=0.03), "rally", 1, 20.0, dt=1e-4)
    recording = read_recording(tmp_path / "rally")
    late = {name: Stream({**stream.columns, "t": stream.t + 1.7e9}) for name, stream in recording.streams().items()}
    found = diagnose([replace(recording, **late)], [], {}, lambda stage, share: None)
    (one,) = found.findings
    assert (one.mechanism, one.also_possible) == ("camera_delay", ())
    assert one.parameters["delay_s"].value == pytest.approx(0.03, abs=0.001)


@pytest.mark.slow
@pytest.mark.skipif(not PRACTICE.exists(), reason="the shared practice recordings are not here")
@pytest.mark.parametrize("name", ["null", *(pytest.param(name, marks=pytest.mark.long) for name in LONG_PRACTICE)])
def test_labelled_practice(name):
    truth = json.loads((PRACTICE / "key.json").read_text())[name]
    found = diagnose([read_recording(PRACTICE / name)], [], {}, lambda stage, share: None)
    assert [one.mechanism for one in found.findings] == truth["mechanisms"]
    if truth["depends"]:
        assert list(found.findings[0].depends_on) == truth["depends"]


@pytest.mark.parametrize("proved, odd, expected", [(True, 0.1, True), (False, 0.1, False), (False, 0.0, True)])
def test_a_law_is_not_reported_on_premises_with_a_misfit_if_large_residuals_remain(proved, odd, expected):
    """Nor are its parameters: the baseline and its residuals are reported. `odd`: a push that differs in every
    launch, which no law explains."""
    pushes = odd * np.random.default_rng(1).normal(size=LAUNCHES)
    problem = LinearProblem({"tilt_x": 0.06, "tilt_y": -0.08, "spin": pushes})
    identified = identify_regime(LinearRegime(proved), problem, NO_EVIDENCE, {})
    final, found = identified.final, identified.regime_result
    assert final is not None and found.selection is not None and found.mismatch is not None
    assert bool(found.findings) == expected == (not found.undetermined) == bool(final.model.laws)
    assert (found.selection.after_m < 0.9 * found.selection.before_m) == expected and not found.misfit
    assert (found.mismatch.after.mean() < 0.9 * found.mismatch.before.mean()) == expected


@pytest.mark.slow
def test_a_restitution_that_falls_with_time_is_reported_as_unlisted(tmp_path):
    """Both components change, as the baseline's restitution has it."""
    found = _diagnosis(tmp_path / "warming", Law(wall_warming=-0.003, wall_restitution=0.85), seconds=60.0)
    (law,) = found.findings
    assert (law.regime, law.mechanism, law.depends_on) == ("wall", "unlisted", ("time",))
    assert "both components" in law.formula
    assert law.parameters["slope"].low < -0.003 < law.parameters["slope"].high
