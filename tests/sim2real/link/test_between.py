"""Lines between points, by hand: a channel from (0, -1..1) to (10, -1..1)."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.link.between import Between

FLOOR, CEILING = np.array([(0.0, -1.0), (10.0, -1.0)]), np.array([(0.0, 1.0), (10.0, 1.0)])
UP = np.array([0.0, 3.0])


@pytest.mark.parametrize("x, half", [(5.0, 1.0), (10.0, 1.0), (20.0, 3.0), (-10.0, 3.0)])
def test_what_all_lines_span(x, half):
    """The steepest go from corner to corner, with slope 0.2 through (5, 0)."""
    lines = Between(FLOOR, CEILING, 1.0)
    assert lines.span(x) == pytest.approx((-half, half), abs=1e-4)
    assert lines.slopes() == pytest.approx((-0.2, 0.2), abs=1e-6)


def test_the_middle_one():
    assert Between(FLOOR + UP, CEILING + UP, 1.0).middle(0.0) == pytest.approx((3.0, 0.0), abs=1e-5)
    assert Between(FLOOR + UP, FLOOR, 1.0).middle(0.0) is None
