"""The files of a diagnosis for the simulator: parameters, effects, and findings that it cannot represent."""

import dataclasses

import pytest

from puckpilot_env import Tables
from puckpilot_env.options.effects_file import effect_values
from sim2real.diagnose.output.effects_toml import effects_toml
from sim2real.diagnose.output.files import as_dict
from sim2real.diagnose.pipeline import Diagnosis, diagnose
from sim2real.diagnose.result.result import Estimate, Finding, Proof, RegimeResult, SensorSummary
from sim2real.recording.folder import read_recording
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.recorder.camera import Camera
from sim2real.study.independent_table.recorder.record import make_recording

SEEN = SensorSummary("table", 9.0, 900, 0.001, 0.001, 0.0, 0.0, 0.0, 0.0, 0.0, 9, 9, 9, 0)
PLAIN = Finding("sensing", "held_frames", (), (), "", {}, 1e-9, 2.0, 1.0, values={"held_frames": 0.1})


def _taken(tmp_path, *findings: Finding, **baseline: float) -> dict[str, float]:
    """Return the simulator's parameters by name from the effects.toml of a diagnosis."""
    numbers = {name: Estimate(value, value, value, "1") for name, value in baseline.items()}
    file = tmp_path / "effects.toml"
    file.write_text(effects_toml(Diagnosis((RegimeResult("sensing", findings, numbers, False, None),))))
    return effect_values(file)


def test_the_camera_s_faults_are_the_simulator_s(tmp_path):
    late = dataclasses.replace(PLAIN, mechanism="camera_delay", values={"camera_latency": 0.018})
    bent = dataclasses.replace(PLAIN, mechanism="scale_error", values={"camera_scale_x": 0.01, "camera_shear": -0.004})
    found = _taken(tmp_path, PLAIN, late, bent, friction=0.09)
    assert found == {
        "held_frames": 0.1,
        "camera_latency": 0.018,
        "camera_scale_x": 0.01,
        "camera_shear": -0.004,
        "friction": 0.09,
    }
    assert Tables("match-sensors-v0", 1, effects=tmp_path / "effects.toml").params["camera_shear"][0] == -0.004


def test_parameters_are_clipped_to_the_simulator_s_range(tmp_path):
    early = dataclasses.replace(PLAIN, mechanism="camera_delay", values={"camera_latency": -0.004})
    assert _taken(tmp_path, early) == {"camera_latency": 0.0}


def test_two_findings_of_one_effect_make_one_table(tmp_path):
    walls = [
        dataclasses.replace(
            PLAIN, regime="wall", mechanism="wall_to_wall_restitution", values={f"restitution_{wall}": e}
        )
        for wall, e in (("x0", 0.05), ("y1", -0.03))
    ]
    assert _taken(tmp_path, *walls) == {"restitution_x0": 0.05, "restitution_y1": -0.03}


def test_comments_explain_the_coefficients(tmp_path):
    force = {"unlisted_kind": 6.0, **{f"unlisted_{k:02}": 0.01 for k in range(14)}}
    _taken(tmp_path, dataclasses.replace(PLAIN, regime="glide", mechanism="unlisted", values=force))
    lines = (tmp_path / "effects.toml").read_text().splitlines()
    at = lines.index("[effects.unlisted_force]")
    assert lines[at - 1].startswith("# an unlisted force: brake by x alone, by y alone; coefficients c00")


def test_a_finding_that_the_simulator_cannot_represent_is_named(tmp_path):
    drift = dataclasses.replace(PLAIN, mechanism="clock_drift", depends_on=("time",), values={})
    assert _taken(tmp_path, drift) == {}
    assert "# not in the simulator: clock_drift of the sensing" in (tmp_path / "effects.toml").read_text()


def test_an_undetermined_regime_is_unchanged(tmp_path):
    numbers = {"wall_restitution": Estimate(0.69, 0.6, 0.8, "1")}
    undetermined = RegimeResult("wall", (), numbers, False, None, undetermined="too few bounces")
    determined = RegimeResult("glide", (), {"friction": Estimate(0.09, 0.08, 0.1, "m/s^2")}, False, None)
    file = tmp_path / "effects.toml"
    file.write_text(effects_toml(Diagnosis((undetermined, determined))))
    assert effect_values(file) == {"friction": 0.09}
    unchanged = "# the wall is unchanged (too few bounces); the fitted values are no better: wall_restitution = 0.69"
    assert unchanged in file.read_text().splitlines() and "the diagnosis is undetermined" not in file.read_text()
    file.write_text(effects_toml(Diagnosis((undetermined,))))
    assert effect_values(file) == {}
    assert "# the diagnosis is undetermined" in file.read_text()
    file.write_text(effects_toml(Diagnosis((dataclasses.replace(undetermined, better=True),))))
    assert effect_values(file) == {"wall_restitution": 0.69}
    assert "# the wall parameters above only improve on the previous ones (too few bounces)" in file.read_text()


def test_invalid_combinations_of_parameters_are_left_out_and_named(tmp_path):
    sizes = {"length": 1.05, "width": 0.55}
    far = {"a1": Estimate(1e-3, 1e-3, 1e-3, "V s^3"), "friction": Estimate(0.09, 0.09, 0.09, "m/s^2")}
    file = tmp_path / "effects.toml"
    for wrong, numbers in ((sizes, {}), ({}, far), (sizes, far)):
        printed = {"friction": far["friction"], **numbers}
        file.write_text(effects_toml(Diagnosis((RegimeResult("glide", (), printed, False, None),), sizes=wrong)))
        assert effect_values(file) == {"friction": 0.09}
        Tables("match-v0", 1, effects=file)
        assert ("# not in the simulator: length 1.05, width 0.55: the table is too small" in file.read_text()) == bool(
            wrong
        )
        assert ("a1 0.001: gantry axis x is not overdamped" in file.read_text()) == bool(numbers)


def test_a_law_that_cannot_be_simulated_is_left_out_and_named(tmp_path):
    force = {"unlisted_kind": 6.0, **{f"unlisted_{k:02}": 1.0 for k in range(14)}}
    sizes = {"length": 2.1, "width": 1.1}
    found = dataclasses.replace(PLAIN, regime="glide", mechanism="unlisted", values=force)
    file = tmp_path / "effects.toml"
    file.write_text(effects_toml(Diagnosis((RegimeResult("glide", (found,), {}, False, None),), sizes=sizes)))
    assert effect_values(file) == sizes
    assert "# not in the simulator: unlisted_force: its force is up to 14 m/s^2; expected at most 5" in file.read_text()


def test_every_regime_has_its_own_result():
    proof = Proof(0.004, 0.001, 0.0009, 7)
    numbers = {"wall_restitution": Estimate(0.69, 0.6, 0.8, "1")}
    found = as_dict(
        Diagnosis(
            (
                RegimeResult("glide", (PLAIN,), {}, False, proof, proof=proof),
                RegimeResult("wall", (), numbers, False, None, undetermined="too few bounces", next_recording="more"),
                RegimeResult("mallet", (), {}, True, proof, proof=proof, doubt="mallet_give would fit"),
                RegimeResult("gantry", (), {}, False, proof, proof=proof),
            ),
            sensor_summaries=(SEEN,),
        )
    )
    shown = {"before_m": 0.004, "after_m": 0.001, "floor_m": 0.0009, "pieces": 7}
    assert found["regimes"] == [
        {"regime": "glide", "verdict": "missing_physics", "heldout": shown},
        {
            "regime": "wall",
            "verdict": "undetermined",
            "reason": "too few bounces",
            "next_recording": "more",
            "baseline": {"wall_restitution": {"value": 0.69, "low": 0.6, "high": 0.8, "unit": "1"}},
        },
        {"regime": "mallet", "verdict": "agrees", "heldout": shown, "doubt": "mallet_give would fit"},
        {"regime": "gantry", "verdict": "parameters_only", "heldout": shown},
    ]


def test_an_untested_regime_is_no_agreement():
    alone = as_dict(
        Diagnosis((RegimeResult("sensing", (), {}, True, None), RegimeResult("gantry", (), {}, True, None)))
    )
    printed = {one["regime"]: one["verdict"] for one in alone["regimes"]}
    assert printed == {"gantry": "agrees", **dict.fromkeys(("sensing", "glide", "wall", "mallet"), "untested")}
    assert "no camera frame shows a puck" in alone["regimes"][1]["reason"]


def test_the_stated_sizes_are_written(tmp_path):
    sizes = {"length": 2.3, "width": 1.1, "puck_radius": 0.05}
    file = tmp_path / "effects.toml"
    file.write_text(effects_toml(Diagnosis((), sizes=sizes)))
    assert effect_values(file) == {"length": 2.3, "width": 1.1}
    assert Tables("match-v0", 1, effects=file).params["length"][0] == 2.3
    assert "# not in the simulator: puck_radius 0.05 m, outside its range 0.01 to 0.045 m" in file.read_text()


@pytest.mark.slow
def test_a_stretched_map_found_in_a_recording(tmp_path):
    law = Law(camera_scale_x=0.012, camera_scale_y=-0.008)
    make_recording(tmp_path / "table", law, "launches", 4, 40.0, camera=Camera(noise=0.0006, rate=150.0), dt=2e-5)
    found = diagnose([read_recording(tmp_path / "table")], [], {}, lambda stage, share: None)
    assert [one.mechanism for one in found.findings] == ["scale_error"]
    (tmp_path / "effects.toml").write_text(effects_toml(found))
    values = effect_values(tmp_path / "effects.toml")
    assert values["camera_scale_x"] == pytest.approx(0.012, abs=0.001)
    assert values["camera_scale_y"] == pytest.approx(-0.008, abs=0.001)
