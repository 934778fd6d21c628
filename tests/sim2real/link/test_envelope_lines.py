"""Lines between points, by hand: a channel from (0, -1..1) to (10, -1..1)."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.link.envelope_lines import EnvelopeLines

FLOOR, CEILING = np.array([(0.0, -1.0), (10.0, -1.0)]), np.array([(0.0, 1.0), (10.0, 1.0)])
UP = np.array([0.0, 3.0])


@pytest.mark.parametrize("x, half", [(5.0, 1.0), (10.0, 1.0), (20.0, 3.0), (-10.0, 3.0)])
def test_what_all_lines_span(x, half):
    """The steepest go from corner to corner, with slope 0.2 through (5, 0)."""
    lines = EnvelopeLines(FLOOR, CEILING, 1.0)
    assert lines.bounds_at(x) == pytest.approx((-half, half), abs=1e-4)
    assert lines.slope_bounds() == pytest.approx((-0.2, 0.2), abs=1e-6)


def test_the_middle_one():
    assert EnvelopeLines(FLOOR + UP, CEILING + UP, 1.0).central_line(0.0) == pytest.approx((3.0, 0.0), abs=1e-5)
    assert EnvelopeLines(FLOOR + UP, FLOOR, 1.0).central_line(0.0) is None
