"""The gantry's diagnosis on recordings of an independent table: effects are identified, absent, or data are refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.consistency import check_consistency
from sim2real.diagnose.engine.cross_validation import select
from sim2real.diagnose.engine.least_squares import fit
from sim2real.diagnose.engine.model_search import search_model
from sim2real.diagnose.input_checks import UndeterminedError
from sim2real.diagnose.regimes.base import RecordingPart, UnusableError
from sim2real.diagnose.regimes.gantry import data
from sim2real.diagnose.regimes.gantry.problem import gantry_problem
from sim2real.diagnose.regimes.gantry.regime import REGIME as GANTRY
from sim2real.diagnose.regimes.gantry.tuned import GANTRY_DATA
from sim2real.diagnose.result.regime_result import regime_result
from sim2real.diagnose.result.result import RegimeResult
from sim2real.recording.folder import Recording, Stream, read_recording
from sim2real.recording.table_parameters import parameters
from sim2real.study.independent_table.physics import volts
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.recorder.record import make_recording
from tests.places import SHARED

SECONDS, STEP = 24.0, 1e-4
OTHER = Law(a1=3.1e-6, a2=0.0062, a3=0.047, b1=-1.5e-6, b2=-0.0031)


def recorded(folder: Path, law: Law, scenario: str = "gantry", seconds: float = SECONDS) -> Recording:
    make_recording(folder, law, scenario, 7, seconds, dt=STEP)
    return read_recording(folder)


def diagnosed(recording: Recording) -> RegimeResult:
    values = parameters(recording)
    problem = gantry_problem([recording], values)[0].with_found_tick()
    defaults = {name: values[name] for name in problem.base}
    return regime_result(
        GANTRY, problem, select(problem, search_model(problem, defaults, problem.everything)), defaults
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    "law, name, parameter, value",
    [
        pytest.param(Law(voltage_sag=0.01), "voltage_sag", "sag", 0.01, marks=pytest.mark.long),
        (replace(OTHER, deadband=0.2), "motor_deadband", "V", 0.2),
        pytest.param(
            Law(motor_friction_left=0.5, motor_friction_right=0.4, axis_friction_y=0.6),
            "motor_friction",
            "V_left",
            0.5,
            marks=pytest.mark.long,
        ),
        (Law(command_delay=0.012), "command_delay", "delay_s", 0.012),
        pytest.param(
            replace(OTHER, belt_hz=16.0, belt_zeta=0.1), "belt_compliance", "hz", 16.0, marks=pytest.mark.long
        ),
        pytest.param(Law(backlash=0.001), "backlash", "gap", 0.001, marks=pytest.mark.long),
        (Law(encoder_clock=-3e-4), "clock_drift", "ppm", -300.0),
    ],
)
def test_one_effect_is_named_and_measured(tmp_path: Path, law: Law, name: str, parameter: str, value: float) -> None:
    found = diagnosed(recorded(tmp_path, law))
    assert [one.mechanism for one in found.findings] == [name]
    assert found.findings[0].where == ({"stream": "mallet"} if name == "clock_drift" else {})
    estimate = found.findings[0].parameters[parameter]
    width = estimate.high - estimate.low
    assert abs(estimate.value - value) < 0.75 * width  # three standard deviations: once in 400 such tests by chance
    assert 0.0 < width < 0.1 * abs(value)
    assert found.selection is not None
    assert found.selection.after_m < 1.1 * found.selection.floor_m < found.selection.before_m


@pytest.mark.slow
@pytest.mark.long
def test_two_effects_are_both_named(tmp_path: Path) -> None:
    found = diagnosed(recorded(tmp_path, Law(voltage_sag=0.02, backlash=0.0015)))
    assert {one.mechanism for one in found.findings} == {"voltage_sag", "backlash"}


def test_nothing_is_named_where_nothing_is_missing(tmp_path: Path) -> None:
    found = diagnosed(recorded(tmp_path, Law()))
    assert found.findings == () and found.defaults


def test_other_numbers_are_no_missing_physics(tmp_path: Path) -> None:
    found = diagnosed(recorded(tmp_path, OTHER))
    assert found.findings == () and not found.defaults
    for name in ("a2", "a3", "b2"):
        assert found.baseline[name].low < getattr(OTHER, name) < found.baseline[name].high


@pytest.mark.slow
@pytest.mark.long
def test_an_unlisted_law_is_named_by_what_it_depends_on(tmp_path: Path) -> None:
    found = diagnosed(recorded(tmp_path, Law(rough=0.2, rough_length=0.4)))
    assert [(one.mechanism, one.depends_on) for one in found.findings] == [("unlisted", ("position",))]


@pytest.mark.slow
def test_a_log_of_the_motors_does_as_well_as_plans(tmp_path: Path) -> None:
    found = diagnosed(recorded(tmp_path, Law(voltage_sag=0.015), "drive", seconds=12.0))
    assert [one.mechanism for one in found.findings] == ["voltage_sag"]
    assert found.findings[0].parameters["sag"].value == pytest.approx(0.015, rel=0.03)


@pytest.mark.slow
@pytest.mark.parametrize(
    "law, names",
    [(Law(), []), pytest.param(Law(belt_hz=14.0, belt_zeta=0.2), ["belt_compliance"], marks=pytest.mark.long)],
)
def test_motors_that_obey_a_plan_at_the_next_tick_lack_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, law: Law, names: list[str]
) -> None:
    exact, tick = volts.sorted_changes, 0.001

    def at_ticks(law: Law, plans: volts.Plans) -> list[tuple[float, tuple[float, float]]]:
        return [(np.ceil((moment - 1e-9) / tick) * tick, pair) for moment, pair in exact(law, plans)]

    monkeypatch.setattr(volts, "sorted_changes", at_ticks)
    recording = recorded(tmp_path, law)
    assert gantry_problem([recording], parameters(recording))[0].with_found_tick().runs[0].drive_inputs.tick == tick
    assert [one.mechanism for one in diagnosed(recording).findings] == names


def test_a_long_log_keeps_windows_with_enough_samples(baseline: Recording, monkeypatch: pytest.MonkeyPatch) -> None:
    """A window keeps enough samples even if few samples of a log are used."""
    monkeypatch.setattr(data, "GANTRY_DATA", replace(GANTRY_DATA, most_samples=100))
    (run,) = gantry_problem([baseline], parameters(baseline))[0].runs
    assert baseline.mallet is not None and len(run.windows.begin) >= baseline.mallet.t[-1] / GANTRY_DATA.window - 1
    assert (run.windows.end - run.windows.begin).min() >= GANTRY_DATA.fewest_samples


@pytest.mark.parametrize(
    "change, reason",
    [
        ({"mallet": None}, "the mallet's path was not recorded"),
        ({"commands": None}, "neither the motors' log"),
    ],
)
def test_a_missing_stream_is_named(tmp_path: Path, change: dict[str, None], reason: str) -> None:
    recording = recorded(tmp_path, Law(), seconds=2.0)
    with pytest.raises(UnusableError, match=reason):
        gantry_problem([replace(recording, **change)], parameters(recording))
    with pytest.raises(UnusableError, match=r"overlap for 2\.0 s, expected 6 s"):
        gantry_problem([recording], parameters(recording))


@pytest.fixture(scope="module")
def baseline(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    """A gantry without any effect."""
    return recorded(tmp_path_factory.mktemp("baseline"), Law(), seconds=12.0)


def blanked(stream: Stream, column: str, rows: slice) -> Stream:
    values = stream[column].copy()
    values[rows] = np.nan
    return Stream({**stream.columns, column: values})


def test_plans_with_blank_cells_are_left_out(baseline: Recording) -> None:
    """The drive inputs between 3.0 s and 4.0 s are unknown; the other windows fit as well as before."""
    assert baseline.commands is not None
    affected = (baseline.commands.t > 2.99) & (baseline.commands.t < 3.99)
    rows = slice(int(np.argmax(affected)), int(np.argmax(affected) + affected.sum()))
    commands = blanked(blanked(baseline.commands, "V_x", rows), "t_y2", rows)
    problem, _ = gantry_problem([replace(baseline, commands=commands)], parameters(baseline))
    run, defaults = problem.runs[0], {name: BY_NAME[name].default for name in problem.base}
    assert not np.any((run.t > commands.t[rows.start]) & (run.t < commands.t[rows.stop]))
    assert len(run.t) > 0.85 * gantry_problem([baseline], parameters(baseline))[0].runs[0].t.size
    left = problem.residuals(defaults, (), np.arange(problem.clusters)).r
    assert left @ left < 1.1 * problem.freedom.sum()


@pytest.mark.parametrize("file, column", [("commands", "V_x"), ("drive", "pwm_left")])
def test_drive_inputs_that_are_all_blank_are_none(baseline: Recording, file: str, column: str) -> None:
    drive = Stream({"t": baseline.mallet.t, "pwm_left": baseline.mallet.t, "pwm_right": baseline.mallet.t})  # type: ignore[union-attr] - this recording holds a mallet
    stream = baseline.commands if file == "commands" else drive
    assert stream is not None
    bare = replace(baseline, **{"commands": None, file: blanked(stream, column, slice(None))})
    with pytest.raises(UnusableError, match=rf"{file}\.csv holds no complete row"):
        gantry_problem([bare], parameters(baseline))


def test_a_log_without_stated_supply_has_the_default_one(baseline: Recording) -> None:
    drive = Stream({"t": np.array([0.0, 20.0]), "pwm_left": np.array([0.5, 0.5]), "pwm_right": np.zeros(2)})
    other = replace(baseline, commands=None, drive=drive)
    problem, _ = gantry_problem([other], parameters(other, {"max_voltage": 10.0}))
    np.testing.assert_allclose(problem.runs[0].drive_inputs.volts, [[5.0, -5.0]])


def test_a_recording_without_a_robot_is_left_out(baseline: Recording) -> None:
    puck_alone = replace(baseline, mallet=None, commands=None)
    problem, runs = gantry_problem([puck_alone, baseline, replace(baseline, commands=None)], parameters(baseline))
    assert runs == [1] and len(problem.runs) == 1


@pytest.mark.slow
def test_residuals_of_one_recording_are_those_rows_of_all(baseline: Recording) -> None:
    problem, _ = gantry_problem([baseline, baseline, baseline], parameters(baseline))
    values = {**{name: problem.defaults(name) for name in problem.base}, "motor_friction_left": 0.3}
    free = ("a1", "b1", "b3", "motor_friction_left")
    every = problem.residuals(values, free, problem.everything)
    for clusters in (problem.clusters_of_runs[1], np.array([0, problem.clusters - 1])):
        some, here = problem.residuals(values, free, clusters), np.isin(every.cluster, clusters)
        assert len(some.r) == here.sum() > 0
        np.testing.assert_array_equal(some.r, every.r[here])
        np.testing.assert_array_equal(some.jacobian, every.jacobian[here])
        np.testing.assert_array_equal(some.cluster, every.cluster[here])


@pytest.mark.slow
def test_two_gantries_are_refused(baseline: Recording, tmp_path: Path) -> None:
    values = parameters(baseline)
    problem, _ = gantry_problem([baseline, recorded(tmp_path, replace(Law(), a2=0.0075), seconds=8.0)], values)
    parts = [RecordingPart(name, part) for name, part in zip("ab", problem.clusters_of_runs, strict=True)]
    with pytest.raises(UndeterminedError, match="a and b are not of one table: a2 is"):
        check_consistency(problem, {name: values[name] for name in problem.base}, parts)


@pytest.mark.slow
@pytest.mark.long
def test_the_labelled_sag_is_found() -> None:
    if not (SHARED / "practice" / "sag").exists():
        pytest.skip("no practice recordings beside the project")
    found = diagnosed(read_recording(SHARED / "practice" / "sag"))
    assert [one.mechanism for one in found.findings] == ["voltage_sag"]
    assert found.findings[0].parameters["sag"].value == pytest.approx(0.02, rel=0.03)


@pytest.mark.parametrize("name", ["gantry_plain_a", "gantry_supercap_a", "gantry_supercap_MaxV"])
def test_the_real_gantry_s_logs_hold_no_sag(name: str) -> None:
    """The mallet is millimetres from every law: a hundred times the encoders' noise, and more than a sag moves it.

    So the supplies with and without a supercapacitor cannot be distinguished; the interval says by how much.
    """
    if not (SHARED / "ubc" / name).exists():
        pytest.skip("no recordings of the real table beside the project")
    recording = read_recording(SHARED / "ubc" / name)
    values = parameters(recording)
    problem, _ = gantry_problem([recording], values)
    start = {row: values[row] for row in problem.base}
    law = fit(problem, start, (*problem.base, "voltage_sag"), np.arange(problem.clusters))
    sag = law.estimate("voltage_sag")
    print(f"{name}: sag {sag.value:.5f} [{sag.low:.5f}, {sag.high:.5f}] {BY_NAME['voltage_sag'].unit}")
    assert sag.low <= 0.0 and sag.high > 0.004
    assert np.sqrt(law.loss / problem.freedom.sum()) > 50.0
