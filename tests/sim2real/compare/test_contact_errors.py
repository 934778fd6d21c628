"""The uncertainty of a contact's prediction, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.compare.contacts import Spin, predict_mallet, predict_wall
from sim2real.compare.map_error import MapError
from sim2real.diagnose.engine.problem import record_of
from sim2real.segmentation.events import ContactEvent
from sim2real.segmentation.mallet_path import MalletPath
from sim2real.segmentation.velocity_jumps import VelocityJump

RESTITUTION = 0.7
SIMULATOR = record_of({"wall_restitution": RESTITUTION, "mallet_restitution": RESTITUTION})
SIZE = np.array([2.0, 1.0])
EXACT = MapError(SIZE, 0.0)
V_IN, V_OUT = np.array([0.0, -2.0]), np.array([0.0, 1.4])
REACH = 0.08  # m, of puck and mallet together
NONE = Spin()
S_IN, S_OUT = 0.01, 0.02  # m/s


def jump(kind: str, where: str, v_out: np.ndarray = V_OUT, time: float = 0.0, place: float = 0.0) -> VelocityJump:
    """A contact at (1, 0.5) and 1 s of a puck that moves along -y, with these standard deviations [s, m]."""
    normal = np.array([0.0, 1.0])
    event = ContactEvent(kind, where, 1.0, 1.0, 0.5, V_IN, v_out, 0.0, (0, 1), 9.0, True, normal)
    covariance = np.diag([time, place, place, S_IN, S_IN, S_OUT, S_OUT]) ** 2
    return VelocityJump(event, np.array([1.0, 1.0, 0.5, *V_IN, *v_out]), covariance, 0)


def mallet(velocity: float, noise: float, acceleration: float = 0.0) -> MalletPath:
    """A mallet that touches the puck from below at 1 s, and moves along y."""
    t = np.arange(401) / 200
    u = t - 1.0
    y = 0.5 - REACH + velocity * u + acceleration * u * u / 2
    return MalletPath(t, np.stack([np.ones_like(t), y], axis=1), noise, (1e-3, 1e-3), (np.zeros(0), np.zeros(0)))


def test_a_wall_s_error_has_that_of_both_velocities() -> None:
    found = predict_wall(jump("wall", "y0"), SIMULATOR, EXACT, NONE)
    assert found.error == pytest.approx([0.0, 0.0], abs=1e-9)
    assert found.std == pytest.approx([np.hypot(S_OUT, RESTITUTION * S_IN)] * 2, rel=1e-5)


def test_a_mallet_s_error_has_that_of_its_velocity_and_of_the_normal() -> None:
    """Along the normal (1 + e) times the mallet's velocity; along the tangent (1 + e) 2 m/s times the angle's."""
    path, place = mallet(0.0, 0.001), 0.0005
    motion = path.motion(1.0)
    assert motion is not None
    m_place, m_v = np.sqrt(np.diag(motion[1][0]))[:2]
    found = predict_mallet(jump("mallet", "robot", place=place), path, SIMULATOR, EXACT, NONE)
    assert found is not None and found.error == pytest.approx([0.0, 0.0], abs=1e-6)
    assert found.std[0] == pytest.approx(np.sqrt(S_OUT**2 + (RESTITUTION * S_IN) ** 2 + (1.7 * m_v) ** 2), rel=1e-4)
    angle = np.hypot(place, m_place) / REACH
    assert found.std[1] == pytest.approx(np.sqrt(S_OUT**2 + S_IN**2 + (1.7 * 2.0 * angle) ** 2), rel=1e-2)


def test_a_late_contact_meets_an_accelerating_mallet_at_another_velocity() -> None:
    late, acceleration = 0.002, 20.0
    path = mallet(0.5, 1e-6, acceleration)
    after = V_OUT + (1.0 + RESTITUTION) * np.array([0.0, 0.5])
    early, sure = (
        predict_mallet(jump("mallet", "robot", after, time), path, SIMULATOR, EXACT, NONE) for time in (late, 0.0)
    )
    assert early is not None and sure is not None and early.error == pytest.approx([0.0, 0.0], abs=1e-3)
    added = np.sqrt(early.std[0] ** 2 - sure.std[0] ** 2)
    assert added == pytest.approx((1.0 + RESTITUTION) * acceleration * late, rel=1e-2)


def test_a_calibration_s_error_adds_what_it_makes_of_velocities() -> None:
    exact, stated = (
        predict_wall(jump("wall", "y0"), SIMULATOR, error, NONE) for error in (EXACT, MapError(SIZE, 0.001))
    )
    assert np.all(stated.std > exact.std)
    doubled = predict_wall(jump("wall", "y0"), SIMULATOR, MapError(SIZE, 0.002), NONE)
    assert doubled.std**2 - exact.std**2 == pytest.approx(4.0 * (stated.std**2 - exact.std**2), rel=1e-6)


def test_a_mallet_that_was_not_sampled_then_predicts_nothing() -> None:
    path = mallet(0.0, 0.001)
    short = MalletPath(path.t[:100], path.p[:100], path.noise, path.jerk, path.switches)
    assert predict_mallet(jump("mallet", "robot"), short, SIMULATOR, EXACT, NONE) is None
