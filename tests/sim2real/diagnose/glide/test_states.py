"""How glides begin and end under a law, and how surely that is known."""

from dataclasses import replace

import numpy as np

from sim2real.diagnose.engine.fit import Fit, given
from sim2real.diagnose.glide.problem import GlideProblem
from sim2real.diagnose.pieces import cut
from sim2real.diagnose.split import glides_of
from sim2real.nominal import parameters
from sim2real.recording import read_recording
from tests.reality.cases import FILM
from tests.reality.film import field
from tests.reality.law import Law
from tests.reality.record import make_recording


def test_a_number_that_is_hardly_known_leaves_all_states_finite(tmp_path):
    make_recording(tmp_path / "table", Law(), "launches", 2, 12.0)
    recording = read_recording(tmp_path / "table")
    values = parameters(recording)
    problem = GlideProblem(glides_of(recording, cut(recording)), values)
    for std in (1e-3, 1e3):  # of both: well known, and by far not, so that one standard deviation would drive the puck
        fitted = Fit(values, ("friction", "drag"), std**2 * np.array([[1.0, -0.9], [-0.9, 1.0]]), 0.0, 1, 1, ())
        assert np.isfinite(problem.states(fitted).drift).all()


def test_what_the_calibration_errs_by_is_not_taken_for_noise_as_well(tmp_path):
    """It is told as drift; a hand that pushes a glide is noise of that glide."""
    law, stated = Law(), 1.8e-4
    make_recording(tmp_path / "film", law, "launches", 2, 30.0, replace(FILM, place_error=1e-9))
    recording = read_recording(tmp_path / "film")
    values = parameters(recording)
    plain = replace(glides_of(recording, cut(recording)), place_std=(stated,))
    off = plain.place + stated * field(plain.place / (law.length, law.width), 3)
    pushed = np.where((np.arange(len(off)) < plain.first[1])[:, None], 2e-4 * np.sin(80.0 * plain.t)[:, None], 0.0)
    truth, filmed, touched = (
        GlideProblem(replace(plain, place=place), values).states(given(values)).spread
        for place in (plain.place, off, off + pushed)
    )
    np.testing.assert_allclose(filmed, truth, rtol=0.05, atol=1e-12)
    assert np.all(np.trace(touched[0, 0]) > 4.0 * np.trace(truth[0, 0]))


def test_drift_is_how_the_ends_move_with_the_calibration(tmp_path):
    """By its numbers, one at a time: of all places moved by what one does, the starts are fitted anew."""
    make_recording(tmp_path / "film", Law(), "launches", 2, 15.0, FILM)
    recording = read_recording(tmp_path / "film")
    values, data = parameters(recording), glides_of(recording, cut(recording))
    problem = GlideProblem(data, values)
    before, off = problem.states(given(values)), problem.errors.modes(data.place)
    for k in (0, 1, 7, 30):
        moved = GlideProblem(replace(data, place=data.place + off[:, :, k]), values).states(given(values))
        np.testing.assert_allclose((moved.motion - before.motion)[:, :, :4], before.drift[:, :, :, k], atol=2e-5)
