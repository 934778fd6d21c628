"""Matrices of two rows, against numpy's own."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.vision.track.covariance import deviation, eigenvalues


@pytest.mark.parametrize("seed", range(5))
def test_as_numpy_has_it(seed):
    half = np.random.default_rng(seed).normal(size=(2, 3))
    matrix = half @ half.T
    assert eigenvalues(matrix) == pytest.approx(tuple(np.linalg.eigvalsh(matrix)))
    assert deviation(matrix) == pytest.approx(np.sqrt(np.linalg.eigvalsh(matrix)[-1]))
