"""Intervals of a parameter in which the prediction saturates: beyond that the data say nothing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.stats import t as student

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine.least_squares import fit
from sim2real.diagnose.engine.problem import Residuals
from sim2real.diagnose.profile_likelihood import with_profiles

NAME, LIMIT, COUNT = "spin_inertia", 0.5, 20
SIGMA = 0.02


@dataclass(frozen=True)
class Saturating:
    """Each launch measures min(parameter, LIMIT) once, as a contact that slides measures its friction alone."""

    seen: np.ndarray
    limit: float = LIMIT
    clusters: int = COUNT

    @property
    def freedom(self) -> np.ndarray:
        return np.ones(COUNT)

    def residuals(self, values: Mapping[str, float], free: Sequence[str], clusters: np.ndarray) -> Residuals:
        value = values[NAME]
        slope = -(value < self.limit) / SIGMA
        r = (self.seen - min(value, self.limit)) / SIGMA
        return Residuals(r[clusters], np.full((len(clusters), len(free)), slope), clusters)


Interval = tuple[float, float]


def interval(truth: float, seed: int, limit: float = LIMIT) -> tuple[Saturating, Interval, Interval]:
    """A problem, and the parameter's interval by curvature and by the profile."""
    noise = SIGMA * np.random.default_rng(seed).standard_normal(COUNT)
    problem = Saturating(min(truth, limit) + noise, limit)
    law = fit(problem, {NAME: 0.45}, (NAME,), np.arange(COUNT))  # pyright: ignore[reportArgumentType]
    both = law, with_profiles(problem, law, (NAME,), np.arange(COUNT))  # pyright: ignore[reportArgumentType]
    by_curvature, by_profile = ((one.estimate(NAME).low, one.estimate(NAME).high) for one in both)
    return problem, by_curvature, by_profile


def test_beyond_saturation_the_interval_holds_the_truth_where_curvature_does_not() -> None:
    held = np.array([[low <= 0.8 <= high for low, high in interval(0.8, seed)[1:]] for seed in range(60)])
    assert held[:, 0].mean() < 0.6 and held[:, 1].mean() > 0.9


@pytest.mark.parametrize("seed", [0, 2, 3, 4])
def test_an_end_is_where_the_loss_has_risen_by_the_square_of_student_s_t(seed: int) -> None:
    problem, (by_curvature, _), (low, high) = interval(0.8, seed)
    assert by_curvature > BY_NAME[NAME].low and (high == BY_NAME[NAME].high or high < LIMIT)
    best = problem.residuals({NAME: min(float(problem.seen.mean()), LIMIT)}, (), np.arange(COUNT)).r
    there = problem.residuals({NAME: low}, (), np.arange(COUNT)).r
    least = float(best @ best)
    rise = student.ppf(0.975, COUNT - 1) ** 2 * max(least / (COUNT - 1), 1.0)
    assert there @ there == pytest.approx(least + rise, rel=0.1)


def test_without_saturation_it_is_that_of_curvature() -> None:
    _, by_curvature, by_profile = interval(0.45, 3, limit=BY_NAME[NAME].high)
    np.testing.assert_allclose(by_profile, by_curvature, atol=0.1 * (by_curvature[1] - by_curvature[0]))


def test_a_parameter_that_is_not_free_has_no_interval() -> None:
    problem = interval(0.8, 1)[0]
    law = fit(problem, {NAME: 0.5}, (), np.arange(COUNT))  # pyright: ignore[reportArgumentType]
    assert not with_profiles(problem, law, (NAME,), np.arange(COUNT)).profiles  # pyright: ignore[reportArgumentType]
