"""Dry friction of motors and axes: its part of a path against the independent table's, in small Runge-Kutta steps."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from puckpilot_env.parameters import make_records
from puckpilot_env.physics.effects.motor_friction import EFFECT
from sim2real.diagnose.engine.least_squares import LeastSquaresFit
from sim2real.diagnose.regimes.gantry import listed_effects
from sim2real.diagnose.regimes.gantry.data import GantryRecording, read_gantry
from sim2real.diagnose.regimes.gantry.listed_effects import StagedFit, _stands_out
from sim2real.diagnose.regimes.gantry.residuals import GantryResiduals
from sim2real.recording.folder import Recording, Stream, read_recording
from sim2real.segmentation.possible_touches import possible_touches
from sim2real.segmentation.segments import segment
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.recorder.record import make_recording

pytestmark = pytest.mark.slow

LAW = Law(motor_friction_left=0.5, motor_friction_right=0.3, axis_friction_x=0.1, axis_friction_y=0.6)
SIZES = {name: float(getattr(LAW, name)) for name in EFFECT.row_names}
SUPPLY, SECONDS = 24.0, 16.0
Lag = dict[str, float]


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    folder = tmp_path_factory.mktemp("rubbing")
    make_recording(folder, LAW, "gantry", 3, SECONDS, dt=1e-4)
    return read_recording(folder)


def left_over(run: GantryRecording, **sizes: float) -> float:
    """The rms of the residuals under the table's own constants and this friction, in units of the noise."""
    return float(np.sqrt(np.mean(run.residuals(make_records(1, sizes)[0])[:, 0] ** 2)))


def second_part(recording: Recording, begin: float) -> Recording:
    """The same with the mallet's path from `begin` [s] on, in the midst of a move."""
    assert recording.mallet is not None
    later = recording.mallet.t >= begin
    columns = {name: column[later] for name, column in recording.mallet.columns.items()}
    return replace(recording, mallet=Stream(columns))


def test_with_the_friction_that_there_was_nothing_is_left_but_noise(recording: Recording) -> None:
    run = read_gantry(recording, SUPPLY, np.zeros(0))
    assert left_over(run, **SIZES) == pytest.approx(1.0, abs=0.05)
    assert left_over(run) > 10.0
    for name, size in SIZES.items():
        assert left_over(run, **{**SIZES, name: size + 0.05}) > 1.3, name


def test_a_small_step_of_all_parameters_does_what_their_derivatives_promise(recording: Recording) -> None:
    """From the table's own constants, by least squares: friction couples the axes and depends on their constants."""
    run = read_gantry(recording, SUPPLY, np.zeros(0))
    problem = GantryResiduals([run], {"max_voltage": SUPPLY})
    free = (*problem.base, *EFFECT.row_names)
    values = {name: SIZES.get(name, problem.defaults(name)) for name in free}
    found = problem.residuals(values, free, problem.everything)
    scale = np.linalg.norm(found.jacobian, axis=0)
    step = np.linalg.lstsq(found.jacobian / scale, -found.r)[0] / scale
    promised = np.sum((found.r + found.jacobian @ step) ** 2) - np.sum(found.r**2)
    moved = {name: values[name] + by for name, by in zip(free, step, strict=True)}
    gained = np.sum(problem.residuals(moved, (), problem.everything).r ** 2) - np.sum(found.r**2)
    assert promised < -1.0
    assert gained == pytest.approx(promised, rel=0.2)


def test_a_path_that_begins_in_a_move_is_run_in_by_the_volts_before_it(recording: Recording) -> None:
    speed = read_gantry(recording, SUPPLY, np.zeros(0))
    fast = speed.t[(speed.t > 4.0) & (np.abs(speed.velocity[:, 0]) > 0.8)][0]
    run = read_gantry(second_part(recording, float(fast)), SUPPLY, np.zeros(0))
    assert left_over(run, **SIZES) == pytest.approx(1.0, abs=0.05)


def test_after_the_puck_pushed_the_mallet_its_friction_has_the_direction_of_its_own_speed(tmp_path: Path) -> None:
    """Of a soft mallet that strikes a puck: no volts tell of its recoil."""
    make_recording(tmp_path, replace(LAW, mallet_give=0.1), "rally", 3, 30.0, dt=1e-4, encoder_noise=1e-5)
    pushed = read_recording(tmp_path)
    run = read_gantry(pushed, SUPPLY, possible_touches(pushed, segment(pushed)))
    assert left_over(run, **SIZES) == pytest.approx(1.1, abs=0.15)
    assert left_over(run.thinned(700), **SIZES) == pytest.approx(1.0, abs=0.15)


@pytest.mark.parametrize(
    ("beside", "parameters"),
    [
        ({"backlash": 0.0015}, {"backlash_gap": 0.0015}),
        ({"belt_hz": 12.0, "belt_zeta": 0.2}, {"belt_hz": 12.0, "belt_zeta": 0.2}),
    ],
)
def test_the_mallet_lags_the_motor_s_path_with_its_friction(tmp_path: Path, beside: Lag, parameters: Lag) -> None:
    make_recording(tmp_path / "lagging", replace(LAW, **beside), "gantry", 3, SECONDS, dt=1e-4)
    run = read_gantry(read_recording(tmp_path / "lagging"), SUPPLY, np.zeros(0))
    assert left_over(run, **SIZES, **parameters) == pytest.approx(1.0, abs=0.06)
    assert left_over(run, **SIZES) > 2.0


def test_a_fit_goes_on_while_its_excess_falls(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a freedom of 100: 500, 300, 120, 119.5; the last step is not worth another."""
    losses = iter([300.0, 120.0, 119.5, 0.0])

    def goes_on(problem: object, values: object, free: object, clusters: object, rounds: int) -> LeastSquaresFit:
        return staged(next(losses)).law

    monkeypatch.setattr(listed_effects, "fit", goes_on)
    problem = SimpleNamespace(everything=np.arange(3))
    found = listed_effects._continued(problem, staged(500.0).law, 100.0)  # type: ignore[arg-type] - all that it asks for
    assert found.loss == 119.5


def staged(loss: float) -> StagedFit:
    fitted = LeastSquaresFit({}, (), np.zeros((0, 0)), loss, 1, ())
    return StagedFit(fitted, fitted)


@pytest.mark.parametrize(
    ("friction", "sag", "expected"),
    [(25.0, 80.0, True), (25.0, 45.0, False), (40.0, 95.0, False)],
    ids=["most, and far more than another", "most, as another nearly does", "not most"],
)
def test_an_effect_is_named_beside_much_misfit_only_if_it_explains_far_more_than_others(
    friction: float, sag: float, expected: bool
) -> None:
    """Of an excess of 100, beside 10 degrees of freedom."""
    fits = {"motor_friction": staged(10.0 + friction), "voltage_sag": staged(10.0 + sag)}
    assert _stands_out(fits, "motor_friction", 100.0, 10.0) == expected
