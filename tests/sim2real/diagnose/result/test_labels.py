"""Parameters derived from fitted ones: values, and intervals compared with samples of the fit's distribution."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import ArrayLike

from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.least_squares import LeastSquaresFit
from sim2real.diagnose.result.labels import labelled

MANY = 100_000  # clusters, so that Student's quantile is the normal one


def fitted(values: dict[str, float], covariance: ArrayLike) -> LeastSquaresFit:
    return LeastSquaresFit(values, tuple(values), np.array(covariance), 0.0, MANY, ())


@pytest.mark.parametrize(
    "mechanism, row, value, label, made",
    [
        ("tangential_restitution", "tangential_ratio", 0.9, "e_t", lambda e, ratio: e * ratio),
        ("corner_restitution", "post_extra", -0.2, "e", lambda e, extra: e + extra),
    ],
)
def test_the_interval_of_a_derived_parameter_propagates_both_errors(mechanism, row, value, label, made):
    for together in (-0.8, 0.0, 0.8):
        covariance = [[4e-4, together * 6e-4], [together * 6e-4, 9e-4]]
        one = labelled(Law(mechanism, (row,)), fitted({"wall_restitution": 0.8, row: value}, covariance))[label]
        sample = np.random.default_rng(1).multivariate_normal([0.8, value], covariance, 200_000)
        low, high = np.quantile(made(*sample.T), (0.025, 0.975))
        assert one.value == pytest.approx(made(0.8, value))
        assert (one.low, one.high) == (pytest.approx(low, abs=0.002), pytest.approx(high, abs=0.002))


def test_a_ratio_of_headings_is_omitted_where_it_may_be_infinite():
    law = Law("friction_anisotropy", ("friction_anisotropy", "friction_turning"))
    for grain, std, expected in ((0.25, 0.05, True), (-0.9, 0.2, True), (0.9, 0.2, False), (1.0, 0.0, False)):
        numbers = labelled(law, fitted({"friction_anisotropy": grain}, [[std**2]]))
        assert ("ratio" in numbers) == expected and numbers["grain"].value == grain
        if expected:
            one = numbers["ratio"]
            assert one.value == pytest.approx((1.0 + grain) / (1.0 - grain))
            assert 0.0 <= one.low < one.value < one.high


def test_the_deviating_wall_has_one_parameter():
    walls = fitted({"wall_restitution": 0.8, "restitution_x1": -0.04, "restitution_y0": 0.06}, np.eye(3) * 1e-6)
    for row, delta in (("restitution_x1", -0.04), ("restitution_y0", 0.06)):
        numbers = labelled(Law("wall_to_wall_restitution", (row,)), walls)
        assert list(numbers) == ["delta"] and numbers["delta"].value == delta
