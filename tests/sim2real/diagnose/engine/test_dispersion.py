"""The dispersion is estimated from the residuals of all laws, for any number of columns."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.linear.dispersion import estimated_dispersion
from sim2real.diagnose.engine.problem import Units

EACH = 2  # residuals of a wall contact
DISPERSION = 4.0  # variance of the noise


def estimate(wall_contacts: int, columns: int, seed: int) -> float:
    rng = np.random.default_rng(seed)
    names = tuple(f"knot {k}" for k in range(columns))
    jacobian = rng.normal(size=(EACH * wall_contacts, 1 + columns))
    r = np.sqrt(DISPERSION) * rng.normal(size=EACH * wall_contacts)
    equations = normal_equations.make_equations(
        ("base", *names), r, jacobian, np.repeat(np.arange(wall_contacts), EACH), wall_contacts
    )
    units = Units(np.arange(wall_contacts) // 4, np.full(wall_contacts, float(EACH)))
    laws = [Law("some", names, "position")]
    return estimated_dispersion(equations, units, ("base",), laws, np.arange(wall_contacts // 4))


@pytest.mark.parametrize(("wall_contacts", "columns"), [(400, 0), (400, 100), (80, 100), (40, 60)])
def test_the_dispersion_is_estimated_for_any_number_of_columns(wall_contacts: int, columns: int) -> None:
    """The median of a chi-square is below its mean: with 8 residuals, as in a launch, by 8 %."""
    found = np.mean([estimate(wall_contacts, columns, seed) for seed in range(10)])
    assert found == pytest.approx(DISPERSION, rel=0.3)
