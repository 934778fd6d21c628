"""A strong smooth law, fitted about the path that it leads along, on a table that the product did not make."""

from dataclasses import replace

import numpy as np
import pytest

from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.fit import fit
from sim2real.diagnose.engine.smooth import fit_smooth
from sim2real.diagnose.glide.problem import GlideProblem
from sim2real.diagnose.pieces import cut
from sim2real.diagnose.split import glides_of
from sim2real.nominal import parameters
from sim2real.recording import read_recording
from tests.reality.law import Law
from tests.reality.record import make_recording

FAMILY = "force by heading"


@pytest.fixture(scope="module")
def grainy(tmp_path_factory):
    """The glides of a table whose friction doubles and vanishes with the heading, and the baseline's best fit."""
    folder = tmp_path_factory.mktemp("grainy")
    make_recording(folder / "table", Law(grain=0.9), "launches", 3, 60.0)
    recording = read_recording(folder / "table")
    values = parameters(recording)
    problem = GlideProblem(glides_of(recording, cut(recording)), values)
    use = np.flatnonzero(problem.freedom > 0)[::2]
    return problem, fit(problem, values, problem.base, use), use


def mean_squares(problem, values, clusters):
    """Of the residuals under a law of parameters, in units of the noise."""
    return np.sum(problem.residuals(values, (), clusters).r ** 2) / problem.freedom[clusters].sum()


def by_name(problem, values, name):
    return next(one for one in problem.columns(values, (), None).families if one.name == name)


def test_a_strong_law_is_fitted_to_the_noise_and_foretells_launches_that_it_never_saw(grainy):
    problem, baseline, use = grainy
    smooth = fit_smooth(problem, baseline, by_name(problem, baseline.values, FAMILY), use, 1.0)
    n = len(smooth.law.free)
    whole = {**smooth.law.values, **smooth.family.switch(smooth.theta[n:])}
    untouched = np.setdiff1d(np.flatnonzero(problem.freedom > 0), use)
    assert mean_squares(problem, baseline.values, untouched) > 20.0
    assert mean_squares(problem, whole, use) < 1.2
    assert mean_squares(problem, whole, untouched) < 1.5
    assert smooth.law.values["friction"] == pytest.approx(Law().friction, rel=0.03)


def test_what_is_claimed_to_be_left_is_what_the_simulator_leaves(grainy):
    problem, baseline, use = grainy
    smooth = fit_smooth(problem, baseline, by_name(problem, baseline.values, FAMILY), use, 1.0)
    n = len(smooth.law.free)
    index, _ = smooth.model.columns(smooth.columns.grams)
    claimed = gram.losses(smooth.columns.grams, index, smooth.theta, problem.units.of(use)).sum()
    whole = {**smooth.law.values, **smooth.family.switch(smooth.theta[n:])}
    assert claimed == pytest.approx(np.sum(problem.residuals(whole, (), use).r ** 2), rel=0.02)


def test_a_family_that_the_simulator_cannot_switch_on_is_fitted_about_the_law_alone(grainy):
    problem, baseline, use = grainy
    smooth = fit_smooth(problem, baseline, by_name(problem, baseline.values, "brake after a contact"), use, 1.0)
    assert smooth.law is baseline
    assert not smooth.family.switch(smooth.theta[len(baseline.free) :])


def test_a_straight_family_is_fitted_about_the_law_alone_and_never_switched_on(grainy):
    """As those of the bounces, of which the columns hold however large the law is."""
    problem, baseline, use = grainy
    family = by_name(problem, baseline.values, FAMILY)
    straight = replace(family, straight=True, switch=lambda theta: pytest.fail("switched on"))
    smooth = fit_smooth(problem, baseline, straight, use, 1.0)
    assert smooth.law is baseline and np.isfinite(smooth.foretold)


def test_a_family_of_which_every_step_leads_uphill_foretells_nothing(grainy, monkeypatch):
    """As where the simulator's switch does the opposite of what the columns say."""
    problem, baseline, use = grainy
    honest = problem.columns

    def opposite(values, free, at):
        found = honest(values, free, at)
        turned = [replace(one, switch=lambda theta, one=one: one.switch(-theta)) for one in found.families]
        return replace(found, families=turned)

    monkeypatch.setattr(problem, "columns", opposite)
    smooth = fit_smooth(problem, baseline, by_name(problem, baseline.values, FAMILY), use, 1.0)
    assert smooth.foretold == np.inf and not smooth.theta.any()
