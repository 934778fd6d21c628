"""A strong smooth term, linearized about the path with it, on a table that the product did not make."""

from dataclasses import replace

import numpy as np
import pytest

from sim2real.diagnose.engine import normal_equations
from sim2real.diagnose.engine.least_squares import fit
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
    """The glides of a table whose friction doubles and vanishes with the heading, and the baseline's best fit."""
    folder = tmp_path_factory.mktemp("grainy")
    make_recording(folder / "table", Law(grain=0.9), "launches", 3, 60.0, dt=5e-5)
    recording = read_recording(folder / "table")
    values = parameters(recording)
    problem = GlideProblem(glides_of(recording, segment(recording)), values)
    use = np.flatnonzero(problem.freedom > 0)[::2]
    return problem, fit(problem, values, problem.base, use), use


def mean_squares(problem, values, clusters):
    """Of the residuals under a law of parameters, in units of the noise."""
    return np.sum(problem.residuals(values, (), clusters).r ** 2) / problem.freedom[clusters].sum()


def by_name(problem, values, name):
    return next(one for one in problem.columns(values, (), None).families if one.name == name)


def test_a_strong_term_is_fitted_to_the_noise_and_predicts_held_out_launches(grainy):
    problem, baseline, use = grainy
    smooth = fit_nonparametric(problem, baseline, by_name(problem, baseline.values, FAMILY), use, 1.0)
    n = len(smooth.law.free)
    whole = {**smooth.law.values, **smooth.family.switch(smooth.theta[n:])}
    held_out = np.setdiff1d(np.flatnonzero(problem.freedom > 0), use)
    assert mean_squares(problem, baseline.values, held_out) > 20.0
    assert mean_squares(problem, whole, use) < 1.2
    assert mean_squares(problem, whole, held_out) < 1.5
    assert smooth.law.values["friction"] == pytest.approx(Law().friction, rel=0.03)


def test_what_is_claimed_to_be_left_is_what_the_simulator_leaves(grainy):
    problem, baseline, use = grainy
    smooth = fit_nonparametric(problem, baseline, by_name(problem, baseline.values, FAMILY), use, 1.0)
    n = len(smooth.law.free)
    index, _ = smooth.model.columns(smooth.columns.equations)
    claimed = normal_equations.losses(smooth.columns.equations, index, smooth.theta, problem.units.of(use)).sum()
    whole = {**smooth.law.values, **smooth.family.switch(smooth.theta[n:])}
    assert claimed == pytest.approx(np.sum(problem.residuals(whole, (), use).r ** 2), rel=0.02)


def test_a_family_that_the_simulator_cannot_switch_on_is_fitted_about_the_law_alone(grainy):
    problem, baseline, use = grainy
    smooth = fit_nonparametric(problem, baseline, by_name(problem, baseline.values, "brake after a contact"), use, 1.0)
    assert smooth.law is baseline
    assert not smooth.family.switch(smooth.theta[len(baseline.free) :])


def test_a_straight_family_is_fitted_about_the_law_alone_and_never_switched_on(grainy):
    """As those of the bounces, of which the columns hold however large the law is."""
    problem, baseline, use = grainy
    family = by_name(problem, baseline.values, FAMILY)
    straight = replace(family, linear=True, switch=lambda theta: pytest.fail("switched on"))
    smooth = fit_nonparametric(problem, baseline, straight, use, 1.0)
    assert smooth.law is baseline and np.isfinite(smooth.cv_loss)


def test_a_term_of_which_every_step_leads_uphill_predicts_nothing(grainy, monkeypatch):
    """As where the simulator's switch does the opposite of what the columns say."""
    problem, baseline, use = grainy
    honest = problem.columns

    def opposite(values, free, at):
        found = honest(values, free, at)
        turned = [replace(one, switch=lambda theta, one=one: one.switch(-theta)) for one in found.families]
        return replace(found, families=turned)

    monkeypatch.setattr(problem, "columns", opposite)
    smooth = fit_nonparametric(problem, baseline, by_name(problem, baseline.values, FAMILY), use, 1.0)
    assert smooth.cv_loss == np.inf and not smooth.theta.any()
