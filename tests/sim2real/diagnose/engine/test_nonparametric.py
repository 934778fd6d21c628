"""A strong smooth term, linearized about the trajectory with it, on an independent simulator's table."""

from dataclasses import replace

import numpy as np
import pytest

from sim2real.diagnose.engine.least_squares import fit
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.nonparametric import fit_nonparametric
from sim2real.diagnose.regimes.sliding.problem import GlideProblem
from sim2real.diagnose.split import glides_of
from sim2real.recording.folder import read_recording
from sim2real.recording.table_parameters import parameters
from sim2real.segmentation.segments import segment
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.recorder.record import make_recording

pytestmark = pytest.mark.slow

FAMILY = "force by heading"


@pytest.fixture(scope="module")
def grainy(tmp_path_factory):
    """The glides of a table with strongly anisotropic friction, and the baseline's best fit."""
    folder = tmp_path_factory.mktemp("grainy")
    make_recording(folder / "table", Law(grain=0.9), "launches", 3, 60.0, dt=5e-5)
    recording = read_recording(folder / "table")
    values = parameters(recording)
    problem = GlideProblem(glides_of(recording, segment(recording)), values)
    use = np.flatnonzero(problem.freedom > 0)[::2]
    return problem, fit(problem, values, problem.base, use), use


def mean_squares(problem, values, clusters):
    """Return the mean square residual under these parameters, in units of the noise."""
    return np.sum(problem.residuals(values, (), clusters).r ** 2) / problem.freedom[clusters].sum()


def by_name(problem, values, name):
    return next(one for one in problem.columns(values, (), None).families if one.name == name)


def test_a_strong_term_is_fitted_to_the_noise_and_predicts_held_out_launches(grainy):
    problem, baseline, use = grainy
    smooth = fit_nonparametric(problem, baseline, by_name(problem, baseline.values, FAMILY), use, 1.0)
    n = len(smooth.law.free)
    values = {**smooth.law.values, **smooth.family.switch(smooth.theta[n:])}
    held_out = np.setdiff1d(np.flatnonzero(problem.freedom > 0), use)
    assert mean_squares(problem, baseline.values, held_out) > 20.0
    assert mean_squares(problem, values, use) < 1.2
    assert mean_squares(problem, values, held_out) < 1.5
    assert smooth.law.values["friction"] == pytest.approx(Law().friction, rel=0.03)


def test_the_linearized_loss_is_that_of_the_simulator(grainy):
    problem, baseline, use = grainy
    smooth = fit_nonparametric(problem, baseline, by_name(problem, baseline.values, FAMILY), use, 1.0)
    n = len(smooth.law.free)
    index, _ = smooth.model.columns(smooth.columns.equations)
    claimed = normal_equations.losses(smooth.columns.equations, index, smooth.theta, problem.units.of(use)).sum()
    values = {**smooth.law.values, **smooth.family.switch(smooth.theta[n:])}
    assert claimed == pytest.approx(np.sum(problem.residuals(values, (), use).r ** 2), rel=0.02)


def test_a_term_that_the_simulator_cannot_represent_is_linearized_about_the_law_alone(grainy):
    problem, baseline, use = grainy
    smooth = fit_nonparametric(problem, baseline, by_name(problem, baseline.values, "brake after a contact"), use, 1.0)
    assert smooth.law is baseline
    assert not smooth.family.switch(smooth.theta[len(baseline.free) :])


def test_a_linear_term_is_linearized_about_the_law_alone(grainy):
    """As for wall contacts, whose columns are exact for laws of any size."""
    problem, baseline, use = grainy
    family = by_name(problem, baseline.values, FAMILY)
    straight = replace(family, linear=True, switch=lambda theta: pytest.fail("switched on"))
    smooth = fit_nonparametric(problem, baseline, straight, use, 1.0)
    assert smooth.law is baseline and np.isfinite(smooth.cv_loss)


def test_a_term_whose_steps_all_increase_the_loss_predicts_nothing(grainy, monkeypatch):
    """As if the simulator's parameters had the opposite effect of the columns."""
    problem, baseline, use = grainy
    original = problem.columns

    def opposite(values, free, at, only=()):
        found = original(values, free, at, only)
        turned = [replace(one, switch=lambda theta, one=one: one.switch(-theta)) for one in found.families]
        return replace(found, families=turned)

    monkeypatch.setattr(problem, "columns", opposite)
    smooth = fit_nonparametric(problem, baseline, by_name(problem, baseline.values, FAMILY), use, 1.0)
    assert smooth.cv_loss == np.inf and not smooth.theta.any()
