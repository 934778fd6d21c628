"""Curves and formulas of a diagnosis of an independent simulator's table, compared with the true laws."""

from dataclasses import replace

import numpy as np
import pytest

from sim2real.diagnose.engine.law import Law as Tried
from sim2real.diagnose.identify_regime import identify_regime
from sim2real.diagnose.pipeline import Diagnosis, diagnose
from sim2real.diagnose.report.page import page
from sim2real.recording.folder import read_recording
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.recorder.camera import Camera
from sim2real.study.independent_table.recorder.record import make_recording
from tests.sim2real.diagnose.engine.linear_problem import NO_EVIDENCE, LinearProblem, LinearRegime

CAMERA = Camera(noise=0.0006, rate=120.0)


def _diagnosis(folder, law: Law, seconds: float = 80.0) -> Diagnosis:
    make_recording(folder, law, "launches", 7, seconds, camera=CAMERA, dt=5e-5)
    return diagnose([read_recording(folder)], [], {}, lambda stage, share: None)


def _curve(found: Diagnosis):
    curve = found.findings[0].curve
    assert curve is not None
    return curve


@pytest.mark.slow
@pytest.mark.long
def test_a_tilt_is_the_same_for_every_heading(tmp_path):
    curve = _curve(_diagnosis(tmp_path / "table", Law(tilt_x=0.01, tilt_y=-0.015)))
    assert curve.x_label.startswith("heading") and "along y" in curve.y_label
    for y, error in ((curve.y, 0.0004), (curve.data_y, 0.004)):
        assert np.abs(y + 0.015).max() < error
    assert (curve.low <= curve.y).all() and (curve.y <= curve.high).all()
    assert np.ptp(curve.x) > 300.0


@pytest.mark.slow
@pytest.mark.long
def test_a_force_that_turns_is_drawn_where_its_law_is(tmp_path):
    """The force varies and rotates within a segment, so that its mean is smaller than its value in the middle."""
    curve = _curve(_diagnosis(tmp_path / "table", Law(vortex=0.1, vortex_size=0.35)))
    assert "round it" in curve.y_label
    r = curve.data_x / 0.35
    true = 0.1 * r * np.exp(0.5 - 0.5 * r**2)
    assert (np.abs(curve.data_y - true) < 1.5 * curve.data_error + 0.005).all()
    assert true.max() > 0.09


@pytest.mark.slow
@pytest.mark.long
def test_restitution_is_a_line_over_the_speed(tmp_path):
    curve = _curve(_diagnosis(tmp_path / "table", Law(restitution_slope=0.05, wall_restitution=0.85)))
    assert curve.y == pytest.approx(0.85 - 0.05 * curve.x, abs=0.003)
    assert curve.data_y == pytest.approx(0.85 - 0.05 * curve.data_x, abs=0.01)


@pytest.mark.slow
@pytest.mark.long
def test_a_decaying_deceleration_gets_its_formula_and_its_mismatch(tmp_path):
    found = _diagnosis(tmp_path / "table", Law(fading=0.25, fading_time=0.3))
    one = found.findings[0]
    assert one.mechanism == "unlisted" and one.depends_on == ("history",)
    assert one.formula.startswith("a = -0.2") and "exp(-t_since_contact / 0.3" in one.formula
    assert one.parameters["size"].value == pytest.approx(-0.25, rel=0.05)
    assert one.parameters["decay"].value == pytest.approx(0.3, rel=0.05)
    curve = _curve(found)
    assert curve.formula == pytest.approx(-0.25 * np.exp(-curve.x / 0.3), abs=0.02)
    mismatch = next(each.mismatch for each in found.regime_results if each.regime == "glide")
    assert mismatch is not None
    before, after = (np.sqrt(np.mean((some / mismatch.std) ** 2)) for some in (mismatch.before, mismatch.after))
    assert before > 2.0
    assert after**2 - 1.0 < 0.1 * (before**2 - 1.0)  # excess over the noise; an unlisted law must reduce it to 0.3
    assert "t_since_contact" in page(found)


@pytest.mark.slow
@pytest.mark.long
def test_a_falling_wall_restitution_gets_a_slope(tmp_path):
    one = _diagnosis(tmp_path / "table", Law(wall_warming=-0.003, wall_restitution=0.85)).findings[0]
    assert (one.mechanism, one.depends_on) == ("unlisted", ("time",))
    assert one.parameters["slope"].value == pytest.approx(-0.003, rel=0.02)
    assert "both components" in one.formula
    assert float(one.formula.split("wall_restitution ")[1]) == pytest.approx(0.85, abs=0.001)


@pytest.mark.slow
@pytest.mark.long
def test_a_falling_mallet_restitution_gets_a_slope(tmp_path):
    law = Law(mallet_warming=-0.004, mallet_restitution=0.85)
    make_recording(tmp_path / "table", law, "rally", 7, 80.0, camera=Camera(noise=0.0006, rate=150.0), dt=5e-5)
    found = diagnose([read_recording(tmp_path / "table")], [], {}, lambda stage, share: None)
    one = found.findings[0]
    assert (one.regime, one.mechanism, one.depends_on) == ("mallet", "unlisted", ("time",))
    assert one.parameters["slope"].value == pytest.approx(-0.004, rel=0.05)
    assert float(one.formula.split("mallet_restitution ")[1]) == pytest.approx(0.85, abs=0.01)
    curve = _curve(found)
    assert curve.formula == pytest.approx(curve.y, abs=0.01)
    assert (np.abs(curve.data_y - np.interp(curve.data_x, curve.x, curve.y)) < 3.0 * curve.data_error).all()


SPEED_LOSS = 2.0 * Law().a3 / Law().pulley_radius  # V s/m, of either axis


@pytest.mark.slow
@pytest.mark.long
def test_a_gantry_rough_by_place_gets_a_wave_in_volts(tmp_path):
    make_recording(tmp_path / "table", Law(rough=0.3, rough_length=0.4), "gantry", 7, 60.0, dt=5e-5)
    found = diagnose([read_recording(tmp_path / "table")], [], {}, lambda stage, share: None)
    one = found.findings[0]
    assert (one.regime, one.depends_on) == ("gantry", ("position",))
    assert one.formula.startswith("extra volts = ") and "times the speed, on both axes" in one.formula
    size, wave, shift = (one.parameters[name].value for name in ("size", "wave", "shift"))
    assert size == pytest.approx(0.3 * SPEED_LOSS, rel=0.02)
    assert wave == pytest.approx(0.4, rel=0.01)
    assert np.cos(2.0 * np.pi * shift / wave) < -0.98  # opposite in sign to the law, which is a loss
    assert float(one.formula.split("a3 ")[1].split()[0]) == pytest.approx(Law().a3, rel=0.005)
    curve = _curve(found)
    expected = -0.3 * SPEED_LOSS * np.sin(2.0 * np.pi * curve.x / 0.4)
    assert curve.formula is not None
    for drawn in (curve.y, curve.formula):  # without the part that the baseline can fit, such as a constant
        assert np.corrcoef(drawn, expected)[0, 1] > 0.98
        assert np.ptp(drawn) == pytest.approx(np.ptp(expected), rel=0.2)  # which is a sixth of the formula
    assert "No data are drawn" in page(found)


@pytest.mark.slow
@pytest.mark.long
def test_a_gantry_that_loses_more_at_speed_gets_a_square(tmp_path):
    make_recording(tmp_path / "table", Law(cubic_loss=0.1), "gantry", 7, 60.0, dt=5e-5)
    found = diagnose([read_recording(tmp_path / "table")], [], {}, lambda stage, share: None)
    one, curve = found.findings[0], _curve(found)
    fast = curve.x > 0.5
    slope, _ = np.polyfit(curve.x[fast] ** 2, curve.y[fast], 1)  # the baseline fits the constant
    assert slope == pytest.approx(-0.1 * SPEED_LOSS, rel=0.15)
    assert (one.regime, one.depends_on) == ("gantry", ("speed",))
    assert "speed^2 V s/m times the speed, on both axes" in one.formula
    assert one.parameters["slope"].value == pytest.approx(-0.1 * SPEED_LOSS, rel=0.03)


@pytest.mark.slow
def test_periodic_friction_is_a_sine_of_time(tmp_path):
    one = _diagnosis(tmp_path / "table", Law(breathing=0.4, breathing_period=9.3), 40.0).findings[0]
    assert (one.mechanism, one.depends_on) == ("unlisted", ("time",))
    assert one.parameters["wave"].value == pytest.approx(9.3, rel=0.01)
    assert abs(one.parameters["size"].value) == pytest.approx(0.4 * Law().friction, rel=0.05)
    assert one.values["unlisted_00"] == pytest.approx(9.3, rel=0.05)  # and the simulator represents it


class _Unlisted(LinearProblem):
    """A linear problem whose missing law is a smooth term."""

    def columns(self, values, free, use, only=()):
        found = super().columns(values, free, use, only)
        return replace(found, listed=[], families=[Tried("push by place", ("tilt_x", "tilt_y"), "position")])


def test_residuals_are_shown_under_the_law_with_its_smooth_term():
    problem = _Unlisted({"tilt_x": 0.02, "tilt_y": -0.03})
    wanted = identify_regime(LinearRegime(), problem, NO_EVIDENCE, {}).regime_result
    assert [one.mechanism for one in wanted.findings] == ["unlisted"]
    assert wanted.mismatch is not None and wanted.selection is not None
    selection, mismatch = wanted.selection, wanted.mismatch
    for shown, rms in ((mismatch.before, selection.before_m), (mismatch.after, selection.after_m)):
        assert np.sqrt(np.mean(shown**2)) == pytest.approx(rms / problem.noise_m, rel=0.02)  # cross-validation
    assert wanted.mismatch.after.mean() < 1.1 < wanted.mismatch.before.mean()


@pytest.mark.slow
@pytest.mark.long
def test_a_law_of_speed_angle_and_spin_is_shown_as_measured_against_predicted(tmp_path):
    law = Law(wall_spin=True, wall_mu=0.15, wall_restitution=0.8)
    curve = _curve(_diagnosis(tmp_path / "table", law))
    assert curve.x_label.endswith("predicted") and curve.y_label.endswith("observed")
    assert curve.y == pytest.approx(curve.x)
    assert np.abs(curve.data_y - curve.data_x).max() < 0.05 < np.ptp(curve.x)
