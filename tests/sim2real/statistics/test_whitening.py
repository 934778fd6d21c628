"""Whitening of common noise, against scipy's root of the full covariance."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import inv, sqrtm

from sim2real.statistics.whitening import whitened


@pytest.mark.parametrize(
    ("rows", "shared", "size"), [(30, 4, 1.0), (30, 4, 1e4), (3, 8, 2.0), (12, 0, 1.0), (6, 2, 0.0)]
)
def test_shared_noise_is_taken_out_by_the_root_of_its_covariance(rows: int, shared: int, size: float) -> None:
    """Also with more shared columns than rows, without columns, and with zero columns."""
    rng = np.random.default_rng(rows + shared)
    columns, some = size * rng.normal(size=(rows, shared)), rng.normal(size=(rows, 2))
    expected = inv(sqrtm(np.eye(rows) + columns @ columns.T)) @ some
    np.testing.assert_allclose(whitened(columns, some), expected, atol=1e-6)
