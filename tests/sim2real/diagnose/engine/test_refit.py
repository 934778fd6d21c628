"""The joint fit of several laws, of which one can settle far from its truth while another is not fitted yet."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sim2real.diagnose.engine.backward_elimination import refit
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.least_squares import fit
from sim2real.diagnose.engine.problem import Residuals

TRUTH = {"wall_mu": 0.7, "tilt_x": 0.1}
LAUNCH, X = np.repeat(np.arange(10), 20), np.linspace(0.0, 3.0, 200)
START = 0.2


class Waves:
    """Measured is a wave of 10 `wall_mu` and one of 2 by `tilt_x`: alone, the first law settles on the second wave."""

    noise_m = 1e-3
    clusters = 10
    freedom = np.full(10, 20.0)

    def residuals(self, values: Mapping[str, float], free: Sequence[str], clusters: np.ndarray) -> Residuals:
        """See `Problem.residuals`."""
        mu, tilt = 10.0 * values["wall_mu"], 100.0 * values["tilt_x"]
        by = {"wall_mu": -60.0 * 10.0 * X * np.cos(mu * X), "tilt_x": -100.0 * 10.0 * np.sin(2.0 * X)}
        r = measured() - 60.0 * np.sin(mu * X) - 10.0 * tilt * np.sin(2.0 * X)
        jacobian = np.array([by.get(name, np.zeros(len(X))) for name in free]).reshape(len(free), len(X)).T
        here = np.isin(LAUNCH, clusters)
        return Residuals(r[here], jacobian[here], LAUNCH[here])


def measured() -> np.ndarray:
    return 60.0 * np.sin(10.0 * TRUTH["wall_mu"] * X) + 1000.0 * TRUTH["tilt_x"] * np.sin(2.0 * X)


def test_a_law_that_settled_far_off_is_fitted_from_its_starts_again_beside_the_next() -> None:
    problem: Any = Waves()
    use = np.arange(10)
    grips = [Law("wall_friction_spin", (f"wall_mu@{mu}",), start={"wall_mu": mu}) for mu in (START, 0.68)]
    tilts = Law("table_tilt", ("tilt_x", "tilt_y"))
    base = {"wall_mu": 0.0, "spin_inertia": 0.5, "spin_decay": 0.5, "tilt_x": 0.0, "tilt_y": 0.0}
    screen: Any = SimpleNamespace(listed=[*grips, tilts])
    alone = refit(problem, fit(problem, base, (), use), grips[:1], screen, use)
    assert alone.values["wall_mu"] == pytest.approx(0.2, abs=0.03)
    both = refit(problem, fit(problem, base, (), use), [grips[0], tilts], screen, use)
    assert both.values["wall_mu"] == pytest.approx(0.7, abs=1e-4) and both.loss < 1e-3
    assert both.values["tilt_x"] == pytest.approx(0.1, abs=1e-4)
