"""The draws.toml of a diagnosis: tables draw parameters within its intervals, about its nominal values."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from puckpilot_env import Tables, all_variants
from puckpilot_env.options.draws_file import read_draws
from puckpilot_env.options.effects_file import effect_values
from sim2real.diagnose.output.draws_toml import draws_toml
from sim2real.diagnose.output.effects_toml import effects_toml
from sim2real.diagnose.pipeline import Diagnosis, diagnose
from sim2real.diagnose.result.context import ReportContext
from sim2real.diagnose.result.result import Estimate, Finding, RegimeResult
from sim2real.recording.folder import read_recording
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.recorder.camera import Camera
from sim2real.study.independent_table.recorder.record import make_recording

PLAIN = Finding("glide", "table_tilt", (), (), "", {}, 1e-9, 2.0, 1.0)
TILT = dataclasses.replace(
    PLAIN,
    values={"tilt_x": 0.02, "tilt_y": -0.19},
    ranges={"tilt_x": Estimate(0.02, 0.018, 0.022, "m/s^2"), "tilt_y": Estimate(-0.19, -0.22, -0.16, "m/s^2")},
)
RUBBING = dataclasses.replace(
    PLAIN,
    regime="wall",
    mechanism="wall_friction_spin",
    values={"wall_mu": 0.11, "spin_inertia": 0.5},
    ranges={"wall_mu": Estimate(0.11, 0.09, 0.13, "1")},
)
VORTEX = dataclasses.replace(
    PLAIN,
    mechanism="unlisted",
    depends_on=("position",),
    values={"unlisted_kind": 6.0, **{f"unlisted_{k:02}": 0.01 for k in range(14)}},
    ranges={},
)
GLIDES = {"friction": Estimate(0.09, 0.08, 0.1, "m/s^2"), "drag": Estimate(0.02, -0.01, 0.05, "1/m")}
COUNT = 300


def gantry(share: float) -> dict[str, Estimate]:
    """The default coefficients, each with an interval of `share` of itself on both sides."""
    defaults = {"a1": 3.6e-6, "a2": 0.0057, "a3": 0.053, "b1": -1.7e-6, "b2": -0.0027, "b3": 0.0}
    return {
        name: Estimate(value, value - share * abs(value), value + share * abs(value), "V s")
        for name, value in defaults.items()
    }


def written(folder: Path, diagnosis: Diagnosis) -> Path:
    (folder / "effects.toml").write_text(effects_toml(diagnosis))
    (folder / "draws.toml").write_text(draws_toml(diagnosis, ReportContext(("monday", 'a "late" evening'))))
    return folder / "draws.toml"


@pytest.fixture
def found() -> Diagnosis:
    return Diagnosis(
        (
            RegimeResult("glide", (TILT,), GLIDES, False, None),
            RegimeResult("wall", (RUBBING,), {"wall_restitution": Estimate(0.8, 0.8, 0.8, "1")}, False, None),
            RegimeResult(
                "mallet", (), {"mallet_restitution": Estimate(0.6, 0.5, 0.7, "1")}, False, None, undetermined="few"
            ),
            RegimeResult("gantry", (), gantry(0.01), False, None),
        ),
        sizes={"length": 2.3, "width": 1.1},
    )


RANGES = {  # each cut off where the simulator's own range ends
    "friction": (0.08, 0.1),
    "drag": (0.0, 0.05),
    "tilt_x": (0.018, 0.022),
    "tilt_y": (-0.2, -0.16),
    "wall_mu": (0.09, 0.13),
}


@pytest.mark.parametrize("variant", all_variants())
def test_tables_of_every_variant_draw_within_the_intervals(variant: str, found: Diagnosis, tmp_path: Path) -> None:
    tables = Tables(variant, COUNT, draws=written(tmp_path, found))
    for name, (low, high) in RANGES.items():
        drawn = tables.params[name]
        assert low <= drawn.min() < low + 0.1 * (high - low) and high - 0.1 * (high - low) < drawn.max() <= high
    same = {"length": 2.3, "width": 1.1, "wall_restitution": 0.8, "spin_inertia": 0.5, "a3": 0.053}
    for name, value in same.items():
        assert (tables.params[name] == value).all(), name
    nominal = {"friction": 0.09, "tilt_y": -0.19, "wall_mu": 0.11}
    assert {name: float(tables.nominal[name][0]) for name in nominal} == nominal
    np.testing.assert_allclose(tables.observation_bounds[1].max(), 180.0 if "match" in variant else 50.0)


def test_beside_an_unlisted_law_nothing_of_its_regime_is_drawn_and_effects_toml_has_it(
    found: Diagnosis, tmp_path: Path
) -> None:
    glide, *others = found.regime_results
    with_vortex = dataclasses.replace(glide, findings=(TILT, VORTEX))
    file = written(tmp_path, dataclasses.replace(found, regime_results=(with_vortex, *others)))
    alone, both = (
        Tables("match-randomized-v0", 50, draws=file, effects=effects) for effects in (None, tmp_path / "effects.toml")
    )
    assert (alone.params["unlisted_kind"] == 0.0).all() and (both.params["unlisted_kind"] == 6.0).all()
    for name, value in {"friction": 0.09, "drag": 0.02, "tilt_x": 0.02, "tilt_y": -0.19}.items():
        assert (both.params[name] == value).all(), name
    assert 0.09 <= both.params["wall_mu"].min() < both.params["wall_mu"].max() <= 0.13
    assert "# not drawn: the unlisted glide law that depends on position, and what else was fitted" in file.read_text()


def test_undetermined_parameters_are_left_to_the_variant(found: Diagnosis, tmp_path: Path) -> None:
    expected = read_draws(written(tmp_path, found))
    assert [draw.parameter for draw in expected.draws] == [*RANGES, "gantry_spread"]
    assert "mallet_restitution" not in expected.parameters  # its regime is undetermined
    drawn = Tables("match-randomized-v0", COUNT, draws=tmp_path / "draws.toml").params["mallet_restitution"]
    assert drawn.min() < 0.5 and drawn.max() > 0.85
    assert expected.draws[0].source == '95 % interval, fitted to the glide of monday and a "late" evening'


def test_parameters_are_those_of_effects_toml(found: Diagnosis, tmp_path: Path) -> None:
    expected = read_draws(written(tmp_path, found)).parameters
    effects = effect_values(tmp_path / "effects.toml")
    assert expected == effects


def test_the_gantry_spread_is_as_wide_as_the_intervals_of_its_coefficients(tmp_path: Path) -> None:
    """The widest relative interval of C6 and C7 is that of axis y, whose C6 = a2 + b2 is the smallest."""
    expected = read_draws(written(tmp_path, Diagnosis((RegimeResult("gantry", (), gantry(0.01), False, None),))))
    (spread,) = expected.draws
    assert (spread.parameter, spread.low) == ("gantry_spread", 0.0)
    assert spread.high == pytest.approx(0.01 * (0.0057 + 0.0027) / (0.0057 - 0.0027), rel=1e-9)
    wide = read_draws(written(tmp_path, Diagnosis((RegimeResult("gantry", (), gantry(0.9), False, None),))))
    assert 0.0 < wide.draws[0].high <= 0.3
    Tables("match-randomized-v0", 1, draws=tmp_path / "draws.toml")


def test_a_diagnosis_without_results_draws_nothing(tmp_path: Path) -> None:
    expected = read_draws(written(tmp_path, Diagnosis((), reason="too short")))
    assert (expected.parameters, expected.draws) == ({}, ())


@pytest.mark.slow
def test_a_tilt_found_in_a_recording_is_drawn_about_the_truth(tmp_path: Path) -> None:
    law = Law(tilt_x=0.015, tilt_y=-0.01)
    make_recording(tmp_path / "table", law, "launches", 5, 30.0, camera=Camera(noise=0.0006, rate=150.0))
    found = diagnose([read_recording(tmp_path / "table")], [], {}, lambda stage, share: None)
    drawn = {draw.parameter: draw for draw in read_draws(written(tmp_path, found)).draws}
    for name, truth in (("tilt_x", 0.015), ("tilt_y", -0.01), ("friction", law.friction)):
        assert drawn[name].low < truth < drawn[name].high
        assert drawn[name].high - drawn[name].low < 0.2 * abs(truth)
