"""Projections, against numpy's least squares."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from sim2real.statistics.projection import project_out_of_parts


@pytest.mark.parametrize("dependent", [False, True])
def test_what_is_left_of_each_part_is_what_least_squares_leaves(dependent: bool) -> None:
    """Also where a column of a part depends on the others, or is nothing."""
    rng = np.random.default_rng(3)
    first = np.array([0, 9, 30, 55])
    columns, targets = rng.normal(size=(55, 4)), rng.normal(size=(55, 3))
    if dependent:
        columns[9:30, 3] = columns[9:30, 0] - 2.0 * columns[9:30, 1]
        columns[30:, 2] = 0.0
    expected = np.concatenate(
        [
            targets[a:b] - columns[a:b] @ np.linalg.lstsq(columns[a:b], targets[a:b], rcond=1e-9)[0]
            for a, b in pairwise(first.tolist())
        ]
    )
    project_out_of_parts(columns, first, targets)
    np.testing.assert_allclose(targets, expected, atol=1e-10)
