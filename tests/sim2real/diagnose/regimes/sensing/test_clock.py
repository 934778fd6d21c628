"""The camera's clock from contacts with a mallet whose path is known in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.diagnose.regimes.sensing.clock import TimedContacts, fit_clock
from sim2real.segmentation.mallet_path import MalletPath

RADII, NOISE, DELAY = 0.08, 1e-4, 0.01
DETERMINED = (True, True)


def path(moves: float, hole: tuple[float, float] = (0.0, 0.0)) -> MalletPath:
    """A mallet that goes to and fro along x by `moves` [m], sampled at 500 Hz but for a hole."""
    t = np.arange(0.0, 40.0, 0.002)
    t = t[(t < hole[0]) | (t >= hole[1])]
    p = np.stack([0.3 + moves * np.sin(3.0 * t), np.full_like(t, 0.5)], axis=1)
    return MalletPath(t, p, 1e-5, (1.0, 1.0), (np.zeros(0), np.zeros(0)))


def contacts(encoders: MalletPath, moves: float, count: int = 40) -> TimedContacts:
    """Contacts at various sides of the mallet, which the camera stamps late by DELAY."""
    random = np.random.default_rng(2)
    t = np.linspace(1.0, 38.0, count)
    angle = random.uniform(-1.0, 1.0, count)
    away = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    mallet = np.stack([0.3 + moves * np.sin(3.0 * t), np.full_like(t, 0.5)], axis=1)
    place = mallet + RADII * away + NOISE * random.standard_normal((count, 2))
    covariance = np.tile(np.diag([1e-10, NOISE**2, NOISE**2]), (count, 1, 1))
    return TimedContacts(t + DELAY, place, away, covariance, np.arange(count), encoders, RADII)


def test_a_delay_is_measured() -> None:
    found = fit_clock([contacts(path(0.1), 0.1)], (0.008, 0.0), DETERMINED)
    assert found is not None and found.clock.delay == pytest.approx(DELAY, abs=0.0005)


def test_a_mallet_at_rest_tells_no_clock() -> None:
    """Its contacts have no closing speed, and the normal equations no inverse."""
    assert fit_clock([contacts(path(0.0), 0.0)], (0.0, 0.0), DETERMINED) is None


def test_a_hole_of_the_encoders_costs_one_contact_alone() -> None:
    """The velocity across a contact just before the hole is not known."""
    whole = contacts(path(0.1), 0.1)
    before = float(whole.t[20] - DELAY) + 0.002
    cut = contacts(path(0.1, (before, before + 0.3)), 0.1)
    found = fit_clock([cut], (0.008, 0.0), DETERMINED)
    assert found is not None and found.clock.delay == pytest.approx(DELAY, abs=0.0005)
    assert 36 <= found.touches.sum() < 40
