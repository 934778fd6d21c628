"""Effect sizes: computed by hand at the ends of glides, and laws below the reported size."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.diagnose.identify_regime import identify_regime
from sim2real.diagnose.regimes.sliding.data import GlideData
from sim2real.diagnose.regimes.sliding.problem import GlideProblem
from tests.sim2real.diagnose.engine.linear_problem import NO_EVIDENCE, LinearProblem, LinearRegime

TABLE = {"length": 2.0, "width": 1.0}


def test_a_tilt_moves_the_end_of_a_glide_by_half_its_time_squared() -> None:
    """Two glides without any friction, of 0.5 and 1 s: 0.5 a t^2 of each, and the root of the mean square of both."""
    t = np.concatenate([np.linspace(0.0, 0.5, 40), np.linspace(2.0, 3.0, 80)])
    place = np.stack([0.3 + 0.5 * np.where(t < 1.0, t, t - 2.0), np.full(len(t), 0.5)], axis=1)
    data = GlideData(
        t, place, np.full((len(t), 2), 1e-4), np.array([0, 40, 120]), np.arange(2), np.zeros(2, int), np.full(2, np.nan)
    )
    problem, law = GlideProblem(data, TABLE), {"friction": 0.0, "drag": 0.0}
    moved = problem.distance_of_ends(law, {**law, "tilt_y": 0.02})
    assert moved == pytest.approx(0.01 * np.sqrt((0.5**4 + 1.0) / 2.0), rel=1e-3)


@pytest.mark.parametrize("size_mm, named", [(0.35, False), (0.8, True)])
def test_a_significant_law_of_negligible_size_is_noted_and_not_reported(size_mm: float, named: bool) -> None:
    """The noise is 1 mm and the tilt adds `size_mm` rms to each of 1,200 residuals, far beyond chance."""
    problem = LinearProblem({"tilt_x": size_mm / 50.0})
    identified = identify_regime(LinearRegime(), problem, NO_EVIDENCE, {})
    assert [one.mechanism for one in identified.regime_result.findings] == (["table_tilt"] if named else [])
    if named:
        assert identified.regime_result.findings[0].size_m == pytest.approx(1e-3 * size_mm, rel=0.15)
        assert identified.regime_result.minor == ""
    else:
        assert identified.regime_result.minor.startswith("table_tilt is significant, but its effect is only 0.3")
        assert identified.regime_result.minor.endswith(
            f"effects below {1e3 * LinearRegime.least_size:g} mm are not reported"
        )
        assert identified.regime_result.verdict in ("agrees", "parameters_only")
