"""Glides extrapolated beyond their frames, against an integrator of scipy's."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sim2real.diagnose.regimes.sliding.trajectory import extrapolated

FRICTION, DRAG = 0.12, 0.13


@pytest.mark.parametrize("duration", [0.115, -0.115, 0.004, 0.0])
@pytest.mark.parametrize("velocity", [(5.0, -0.3), (-0.4, 0.5), (0.05, 0.0)])
def test_a_tenth_of_a_second_on_or_back(velocity: tuple[float, float], duration: float) -> None:
    beyond = np.array([0.05, -0.2])

    def motion(_, state: np.ndarray) -> np.ndarray:
        v = state[2:]
        speed = np.hypot(*v)
        return np.concatenate([v, beyond - FRICTION * v / speed - DRAG * speed * v])

    start = np.array([1.0, 0.4, *velocity])
    truth = solve_ivp(motion, (0.0, duration), start, rtol=1e-11, atol=1e-12).y[:, -1] if duration else start
    place, moving = extrapolated(start[:2], start[2:], beyond, FRICTION, DRAG, duration)
    np.testing.assert_allclose(place, truth[:2], rtol=0.0, atol=1e-7)  # m
    np.testing.assert_allclose(moving, truth[2:], rtol=0.0, atol=2e-5)  # m/s


def test_a_puck_at_rest_stays_where_it_is() -> None:
    place, velocity = extrapolated(np.array([0.3, 0.2]), np.zeros(2), np.zeros(2), FRICTION, DRAG, 0.1)
    assert place.tolist() == [0.3, 0.2] and velocity.tolist() == [0.0, 0.0]
