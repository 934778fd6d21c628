"""The share of the excess variance that a law explains."""

import pytest

from sim2real.diagnose.result.result import explained


@pytest.mark.parametrize(
    "before, after, share",
    [(3.0, 1.0, 1.0), (3.0, 3.0, 0.0), (3.0, 5.0**0.5, 0.5), (2.0, 2.5, -0.75), (1.0, 0.9, 0.0), (0.9, 0.8, 0.0)],
)
def test_the_share_of_the_excess_variance(before, after, share):
    assert explained(before, after) == pytest.approx(share)
