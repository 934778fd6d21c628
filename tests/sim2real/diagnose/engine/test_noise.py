"""Noise beyond the sensor's is read off what all laws leave, however many columns they have."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import Law
from sim2real.diagnose.engine.noise import dispersion
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
