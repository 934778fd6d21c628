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


@pytest.mark.parametrize("seed", range(20))
def test_the_central_line_is_the_best_of_a_fine_grid(seed):
    """Delays like those of exchanges: above and below a line of which the slope is or is not well determined."""
    random = np.random.default_rng(seed)
    x = np.sort(random.uniform(-10.0, 0.0, random.integers(1, 60)))
    line = random.uniform(-2e-4, 2e-4) * x
    lower = np.column_stack([x, line - random.exponential(2e-4, x.size)])
    upper = np.column_stack([x, line + random.exponential(2e-4, x.size)])
    slopes = np.linspace(-3e-4, 3e-4, 20_001)[:, None]
    lowest, highest = (lower[:, 1] - slopes * x).max(axis=1), (upper[:, 1] - slopes * x).min(axis=1)
    for penalty in (0.0, 0.1):
        offset, slope = EnvelopeLines(lower, upper, 3e-4).central_line(penalty) or (np.nan, np.nan)
        found = (upper[:, 1] - slope * x).min() - (lower[:, 1] - slope * x).max() - penalty * abs(slope)
        best = (highest - lowest - penalty * abs(slopes[:, 0])).max()
        assert best - 1e-12 <= found < best + 1e-6
        assert offset == pytest.approx(((upper[:, 1] - slope * x).min() + (lower[:, 1] - slope * x).max()) / 2)
    inside = slopes[highest >= lowest, 0]
    bounds = EnvelopeLines(lower, upper, 3e-4).slope_bounds()
    assert bounds == pytest.approx((inside.min(), inside.max()), abs=4e-8)
