"""The network of a table's residuals: recordings of the independent table with a tilt give corrections of its size."""

from __future__ import annotations

import importlib.util
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from puckpilot_env import Tables
from puckpilot_env.options.at_table import AT_TABLE
from puckpilot_env.residual.network import load_residual
from puckpilot_env.residual.tables import ResidualTables
from sim2real.gap import residual_fit
from sim2real.gap.arms import Simulator, write_simulator
from sim2real.gap.residual_data import Samples, read_samples
from sim2real.gap.residual_fit import fit_residual
from sim2real.study.independent_table import Law
from sim2real.study.independent_table.recorder.camera import Camera
from sim2real.study.independent_table.recorder.record import make_recording

pytestmark = pytest.mark.slow

TILT = np.array([-0.2, 0.15])  # m/s^2
STEP = 0.1  # s
SHARP = Camera(rate=120.0, noise=1e-4, jitter=0.0)


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Two matches on a table that leans."""
    folder = tmp_path_factory.mktemp("tilted")
    law = Law(tilt_x=TILT[0], tilt_y=TILT[1])
    for seed in range(2):
        make_recording(folder / f"game_{seed}", law, "match", seed, 40.0, SHARP, dt=1e-4)
    return sorted(folder.iterdir())


@pytest.fixture(scope="module")
def samples(recordings: list[Path]) -> Samples:
    return read_samples(recordings, AT_TABLE)


def test_what_a_step_lacks_on_a_leaning_table_is_the_tilt(samples: Samples) -> None:
    """Most steps are glides: half the tilt times the step squared, and the tilt times the step."""
    assert len(samples) > 350 and samples.inputs.shape == (len(samples), 18)
    place, velocity = np.median(samples.missed, axis=0).reshape(2, 2)
    assert place == pytest.approx(TILT * STEP**2 / 2, rel=0.05)
    assert velocity == pytest.approx(TILT * STEP, rel=0.05)


def test_the_network_takes_most_of_it_from_steps_that_it_never_saw(samples: Samples) -> None:
    residual, report = fit_residual(samples)
    for name in ("x", "y", "vx", "vy"):
        assert report["median"][name]["after"] < 0.3 * report["median"][name]["before"]
    assert report["rms"]["x"]["after"] < 0.5 * report["rms"]["x"]["before"]
    assert report["samples"] + report["held_out"] == len(samples) and report["held_out"] > 60
    corrections = np.median(residual(samples.inputs), axis=0)
    assert corrections[2:] == pytest.approx(TILT * STEP, rel=0.15)
    again, _ = fit_residual(samples)
    assert again(samples.inputs).tobytes() == residual(samples.inputs).tobytes()


def test_the_arm_s_simulator_plays_nearer_to_the_leaning_table(recordings: list[Path], tmp_path: Path) -> None:
    """One step from the same games on the simulator, the corrected one, and the simulator with the true tilt."""
    files = write_simulator(Simulator(residual_of=tuple(recordings)).at_table({}), tmp_path)
    assert files["residual"] == tmp_path / "residual.npz"
    assert json.loads((tmp_path / "residual.json").read_text())["format"] == "puckpilot-residual-fit/1"
    plain = Tables("match-v0", 200, seed=1, parameters=AT_TABLE)
    corrected = ResidualTables("match-v0", 200, load_residual(files["residual"]), seed=1, parameters=AT_TABLE)
    true = Tables("match-v0", 200, seed=1, parameters={**AT_TABLE, "tilt_x": TILT[0], "tilt_y": TILT[1]})
    rng, (low, high) = np.random.default_rng(0), plain.action_bounds
    off = {"plain": [], "corrected": []}
    for step in range(20):
        actions = rng.uniform(low, high, (200, 2, 4))
        for one in (plain, corrected):
            one.states[:] = true.states
        for one in (plain, corrected, true):
            one.step(actions)
        if step < 3:
            continue
        for name, one in (("plain", plain), ("corrected", corrected)):
            rows = corrected.went_on
            off[name] += np.abs(one.states["puck"]["vx"] - true.states["puck"]["vx"])[rows].tolist()
    assert np.median(off["plain"]) == pytest.approx(-TILT[0] * STEP, rel=0.05)
    assert np.median(off["corrected"]) < 0.35 * np.median(off["plain"])


def test_the_numpy_network_is_scikit_learn_s(samples: Samples, monkeypatch: pytest.MonkeyPatch) -> None:
    from sklearn.neural_network import MLPRegressor

    fitted = []
    fit = MLPRegressor.fit
    monkeypatch.setattr(MLPRegressor, "fit", lambda self, x, y: fitted.append(fit(self, x, y)) or fitted[-1])
    residual, _ = fit_residual(samples)
    standard = (samples.inputs - residual.centre) / residual.span
    theirs = residual.middle + residual.scale * fitted[0].predict(standard)
    within = (np.abs(theirs) < residual.bound).all(axis=1)
    assert within.mean() > 0.9
    assert residual(samples.inputs)[within] == pytest.approx(theirs[within], abs=1e-4)


def test_too_little_and_what_is_not_installed_is_said_in_one_line(
    samples: Samples, monkeypatch: pytest.MonkeyPatch
) -> None:
    few = Samples(samples.inputs[:49], samples.missed[:49], samples.blocks[:49])
    with pytest.raises(ValueError, match=r"show 49 steps .* expected 50 from 5 or more: record more games"):
        fit_residual(few)
    with pytest.raises(ValueError, match="from 1 pieces"):
        fit_residual(replace(samples, blocks=np.zeros_like(samples.blocks)))
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ValueError, match=r"needs scikit-learn; install it with: pip install 'puckpilot\[train\]'"):
        residual_fit.require_sklearn()


def test_a_recording_without_commands_or_of_another_size_shows_no_steps(tmp_path: Path) -> None:
    make_recording(tmp_path / "launches", Law(), "launches", 0, 4.0, SHARP, dt=1e-4)
    assert len(read_samples([tmp_path / "launches"], AT_TABLE)) == 0
    make_recording(tmp_path / "large", Law(length=2.2), "match", 0, 4.0, SHARP, dt=1e-4)
    with pytest.raises(ValueError, match=r"large: its length is 2\.2 m, that of the simulator 2 m"):
        read_samples([tmp_path / "large"], AT_TABLE)
