"""The bench's errors against the bars of the vision, on few pictures; times are not tested."""

from __future__ import annotations

import json

import numpy as np
import pytest

import puckpilot
from sim2real.vision.trial.bench import BenchmarkTable, centre_errors
from sim2real.vision.trial.rendered_calibration import detector_for
from tests.sim2real.vision.track.games import judge_before, share_within


@pytest.fixture(scope="module")
def bench() -> BenchmarkTable:
    return BenchmarkTable.with_estimated_calibration(1)


def test_with_an_estimated_calibration_the_disc_keeps_the_bars_and_the_baselines_do_not(bench: BenchmarkTable):
    clear, half = centre_errors(bench, 60, hidden=False, seed=2), centre_errors(bench, 60, hidden=True, seed=3)
    assert np.mean(clear["disc"]) < 0.3e-3 and np.percentile(clear["disc"], 95) < 0.5e-3
    assert np.median(half["disc"]) < 0.5e-3 and np.percentile(half["disc"], 99) < 2e-3
    assert np.median(half["report C.2"]) > 0.5e-3 and np.median(half["centroid"]) > 5e-3


def test_in_a_game_deviations_are_honest_if_the_calibration_s_error_is_stated(bench: BenchmarkTable):
    """0.1 mm along each axis: eight such calibrations have 0.093 mm, root mean square."""
    for error, low, high in ((0.0, 0.0, 0.6), (0.1e-3, 0.85, 1.0)):
        judged = judge_before(detector_for(bench.renderer, bench.locator, error), bench.renderer, 60, seed=1).values()
        assert low <= share_within([square for one in judged for square in one.squares]) <= high
        assert share_within([square for one in judged for square in one.speeds]) > 0.85


def test_the_command_tells_times_and_errors(capsys):
    assert puckpilot.main(["bench", "vision", "--pictures", "3", "--json"]) == 0
    output = json.loads(capsys.readouterr().out)
    assert set(output) == {"full frame", "region of interest", "clear", "half hidden"}
    assert all(one["found"] == one["pictures"] == 3 for one in output["clear"].values())
    assert min(output["region of interest"][name] for name in ("median_ms", "p90_ms", "again_median_ms")) > 0.0


@pytest.mark.parametrize("words", [["--pictures", "0"], ["--seed", "-1"]])
def test_impossible_sizes_are_refused(words, capsys):
    assert puckpilot.main(["bench", "vision", *words]) == 2
    assert f"{words[0]} is {words[1]}; expected a whole number from" in capsys.readouterr().err
