"""How glides begin and end under a law, and how surely that is known."""

import numpy as np

from sim2real.diagnose.apart import glides_of
from sim2real.diagnose.engine.fit import Fit
from sim2real.diagnose.glide.problem import GlideProblem
from sim2real.diagnose.pieces import cut
from sim2real.nominal import parameters
from sim2real.recording import read_recording
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
