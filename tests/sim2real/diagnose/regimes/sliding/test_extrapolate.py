"""Glides extrapolated beyond their frames, against an integrator of scipy's."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from puckpilot_env.parameters import make_records
from sim2real.diagnose.regimes.sliding.trajectory import extrapolated

FRICTION, DRAG = 0.12, 0.13
PATCH = {"patch_x": 1.2, "patch_y": 0.4, "patch_radius": 0.1, "patch_extra": 2.0}


def truth(start: np.ndarray, more: np.ndarray, duration: float, patch: dict[str, float]) -> np.ndarray:
    """Place and velocity (4,) `duration` [s] later, with more friction in the `patch`."""

    def motion(_: float, state: np.ndarray) -> np.ndarray:
        place, v = state[:2], state[2:]
        inside = bool(patch) and np.hypot(place[0] - 1.2, place[1] - 0.4) < 0.1
        speed = np.hypot(*v)
        return np.concatenate([v, more - (FRICTION + 2.0 * inside) * v / speed - DRAG * speed * v])

    found = solve_ivp(motion, (0.0, duration), start, rtol=1e-10, atol=1e-12, max_step=1e-4)
    return found.y[:, -1] if duration else start


@pytest.mark.parametrize("duration", [0.115, -0.115, 0.004, 0.0])
@pytest.mark.parametrize("velocity", [(5.0, -0.3), (-0.4, 0.5), (0.05, 0.0)])
@pytest.mark.parametrize("patch", [{}, PATCH], ids=["bare", "patch"])
def test_a_tenth_of_a_second_on_or_back(
    velocity: tuple[float, float], duration: float, patch: dict[str, float]
) -> None:
    """From 1.0, 0.4 and, where there is a patch, from beside it."""
    more = np.array([0.05, -0.2])
    start = np.array([1.08 if patch and duration > 0.0 else 1.35 if patch else 1.0, 0.4, *velocity])
    record = make_records(1, {"friction": FRICTION, "drag": DRAG, **patch})
    place, moving = extrapolated(record, 3.0, start[:2], start[2:], more, duration)
    expected = truth(start, more, duration, patch)
    np.testing.assert_allclose(place, expected[:2], rtol=0.0, atol=1e-4 if patch else 1e-7)  # m
    np.testing.assert_allclose(moving, expected[2:], rtol=0.0, atol=2e-3 if patch else 2e-5)  # m/s
    if patch and abs(duration) > 0.1 and velocity[0] == 5.0:
        bare = truth(start, more, duration, {})
        assert np.abs(bare - expected).max() > 0.05  # so it says something


def test_a_law_that_depends_on_time_counts_from_the_frame() -> None:
    record = make_records(1, {"friction": FRICTION, "drag": 0.0, "air_drift": 0.01})
    _, early = extrapolated(record, 0.0, np.zeros(2), np.array([1.0, 0.0]), np.zeros(2), 0.1)
    _, late = extrapolated(record, 50.0, np.zeros(2), np.array([1.0, 0.0]), np.zeros(2), 0.1)
    assert 1.0 - early[0] == pytest.approx(0.1 * FRICTION, rel=1e-3)
    assert 1.0 - late[0] == pytest.approx(0.1 * 1.5 * FRICTION, rel=1e-3)


def test_a_puck_at_rest_stays_where_it_is() -> None:
    record = make_records(1, {"friction": FRICTION, "drag": DRAG})
    place, velocity = extrapolated(record, 0.0, np.array([0.3, 0.2]), np.zeros(2), np.zeros(2), 0.1)
    assert place.tolist() == [0.3, 0.2] and velocity.tolist() == [0.0, 0.0]
