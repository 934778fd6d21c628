"""States at the ends of glides under a law, and their covariances."""

from dataclasses import replace

import numpy as np

from sim2real.diagnose.engine.least_squares import LeastSquaresFit, given
from sim2real.diagnose.regimes.sliding.problem import GlideProblem
from sim2real.diagnose.split import glides_of
from sim2real.recording.folder import read_recording
from sim2real.recording.table_parameters import parameters
from sim2real.segmentation.segments import segment
from sim2real.study.independent_table.cases import FILM
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.recorder.film import field
from sim2real.study.independent_table.recorder.record import make_recording


def test_a_parameter_that_is_hardly_known_leaves_all_states_finite(tmp_path):
    make_recording(tmp_path / "table", Law(), "launches", 2, 12.0)
    recording = read_recording(tmp_path / "table")
    values = parameters(recording)
    problem = GlideProblem(glides_of(recording, segment(recording)), values)
    for std in (1e-3, 1e3):  # the second so large that one standard deviation would drive the puck
        fitted = LeastSquaresFit(
            values, ("friction", "drag"), std**2 * np.array([[1.0, -0.9], [-0.9, 1.0]]), 0.0, 1, ()
        )
        assert np.isfinite(problem.states(fitted).drift).all()


def test_the_map_error_does_not_count_as_noise_as_well(tmp_path):
    """The map error is in the drift; a hand that pushes a glide is noise of that glide."""
    law, stated = Law(), 1.8e-4
    make_recording(tmp_path / "film", law, "launches", 2, 30.0, replace(FILM, place_error=1e-9))
    recording = read_recording(tmp_path / "film")
    values = parameters(recording)
    data = glides_of(recording, segment(recording))
    exact = replace(data, noise=(replace(data.noise[0], map_error_std=stated),))
    off = exact.place + stated * field(exact.place / (law.length, law.width), 3)
    pushed = np.where((np.arange(len(off)) < exact.first[1])[:, None], 2e-4 * np.sin(80.0 * exact.t)[:, None], 0.0)
    truth, filmed, touched = (
        GlideProblem(replace(exact, place=place), values).states(given(values)).spread
        for place in (exact.place, off, off + pushed)
    )
    np.testing.assert_allclose(filmed, truth, rtol=0.05, atol=1e-12)
    assert np.all(np.trace(touched[0, 0]) > 4.0 * np.trace(truth[0, 0]))


def test_drift_is_how_the_ends_move_with_the_calibration(tmp_path):
    """One mode at a time: the starts are fitted again to all places, displaced by it."""
    make_recording(tmp_path / "film", Law(), "launches", 2, 15.0, FILM)
    recording = read_recording(tmp_path / "film")
    values, data = parameters(recording), glides_of(recording, segment(recording))
    problem = GlideProblem(data, values)
    before, off = problem.states(given(values)), problem.errors.modes(data.place)
    for k in (0, 1, 7, 30):
        moved = GlideProblem(replace(data, place=data.place + off[:, :, k]), values).states(given(values))
        np.testing.assert_allclose((moved.motion - before.motion)[:, :, :4], before.drift[:, :, :, k], atol=2e-5)
