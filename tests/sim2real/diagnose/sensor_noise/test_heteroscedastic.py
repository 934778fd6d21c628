"""Synthetic noise whose variance differs over the table."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.diagnose.sensor_noise.autocorrelated import Excerpt
from sim2real.diagnose.sensor_noise.heteroscedastic import estimate_log_variance, std_ratio

ORDER, ASSUMED = 4, 2e-5


def drawn(rng: np.random.Generator, glides: int, law: tuple[float, float, float], rough: int = 0) -> list[Excerpt]:
    """Glides of 60 frames with the logarithm of the variance linear in x and y; `rough` of them are outliers."""
    found = []
    for k in range(glides):
        start, end = rng.uniform((0.1, 0.1), (1.9, 0.9), (2, 2))
        place = start + np.linspace(0.0, 1.0, 60)[:, None] * (end - start)
        std = ASSUMED * np.exp(0.5 * (law[0] + place @ law[1:]))[:, None]
        errors = std * rng.normal(size=place.shape) * (20.0 if k < rough else 1.0)
        found.append(Excerpt(np.arange(60) / 120.0, place + errors, np.full((60, 2), ASSUMED)))
    return found


@pytest.mark.parametrize("rough", [0, 6])
def test_the_variance_over_the_table_is_found(rough: int) -> None:
    law = (-0.4, 1.2, -0.5)
    found = estimate_log_variance(drawn(np.random.default_rng(1), 80, law, rough), ORDER)
    place = np.random.default_rng(2).uniform((0.0, 0.0), (2.0, 1.0), (50, 2))
    expected = np.exp(0.5 * (law[0] + place @ law[1:]))
    assert std_ratio(place, found)[:, 0] == pytest.approx(expected, rel=0.2 if rough else 0.1)


def test_slopes_scatter_as_expected_of_gamma_variables() -> None:
    """80 parts of 110 degrees of freedom: each log variance has a standard deviation of sqrt(2 / 110)."""
    slopes = [estimate_log_variance(drawn(np.random.default_rng(k), 80, (0.0, 0.0, 0.0)), ORDER)[1] for k in range(40)]
    assert abs(np.mean(slopes)) < 0.02 and np.std(slopes) < 0.08


def test_few_glides_give_zeros() -> None:
    assert not estimate_log_variance(drawn(np.random.default_rng(1), 3, (1.0, 1.0, 1.0)), ORDER).any()
