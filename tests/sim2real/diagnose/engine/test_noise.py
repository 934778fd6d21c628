"""Noise beyond the sensor's is read off what all laws leave, however many columns they have."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import inv, sqrtm

from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.noise import allowing_for, dispersion
from sim2real.diagnose.problem import Units

EACH = 2  # residuals of a bounce
BEYOND = 4.0  # variance of the noise


def read_off(bounces: int, columns: int, seed: int) -> float:
    rng = np.random.default_rng(seed)
    names = tuple(f"knot {k}" for k in range(columns))
    jacobian = rng.normal(size=(EACH * bounces, 1 + columns))
    r = np.sqrt(BEYOND) * rng.normal(size=EACH * bounces)
    grams = gram.make_grams(("base", *names), r, jacobian, np.repeat(np.arange(bounces), EACH), bounces)
    units = Units(np.arange(bounces) // 4, np.full(bounces, float(EACH)))
    return dispersion(grams, units, ("base",), [Law("some", names, "position")], np.arange(bounces // 4))


@pytest.mark.parametrize(("bounces", "columns"), [(400, 0), (400, 100), (80, 100), (40, 60)])
def test_noise_is_read_off_however_rich_the_laws(bounces: int, columns: int) -> None:
    """The median of what few residuals leave lies below their mean: of 8, which a launch has, by 8 %."""
    found = np.mean([read_off(bounces, columns, seed) for seed in range(10)])
    assert found == pytest.approx(BEYOND, rel=0.3)


@pytest.mark.parametrize(
    ("rows", "shared", "size"), [(30, 4, 1.0), (30, 4, 1e4), (3, 8, 2.0), (12, 0, 1.0), (6, 2, 0.0)]
)
def test_shared_noise_is_taken_out_by_the_root_of_its_covariance(rows: int, shared: int, size: float) -> None:
    """Against scipy's matrix root; more shared columns than rows, none, and such as are nothing, too."""
    rng = np.random.default_rng(rows + shared)
    columns, some = size * rng.normal(size=(rows, shared)), rng.normal(size=(rows, 2))
    expected = inv(sqrtm(np.eye(rows) + columns @ columns.T)) @ some
    np.testing.assert_allclose(allowing_for(columns, some), expected, atol=1e-6)
