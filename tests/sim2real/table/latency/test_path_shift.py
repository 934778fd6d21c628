"""Delays and drifts between two clocks come back, with intervals that hold them as often as they say."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from sim2real.table.latency.path_shift import NotDeterminedError, path_shift
from tests.sim2real.table.latency.strokes import correlated_noise, encoders, frames

DELAYS = (0.0, 0.005, 0.017, 0.033, 0.06)
DRIFTS = (-50e-6, 0.0, 50e-6)
NONE = np.zeros((10_000, 2))


def white(seed: int, size: float = 1e-4) -> np.ndarray:
    return size * np.random.default_rng(seed).standard_normal((10_000, 2))


def true_delay(delay: float, drift: float, middle: float) -> float:
    """The stamp `middle` less the time of its exposure, by hand: s = (1 + drift) t + delay."""
    return middle - (middle - delay) / (1.0 + drift)


@pytest.mark.parametrize(("delay", "drift"), list(itertools.product(DELAYS, DRIFTS)))
def test_injected_delays_and_drifts_come_back(delay: float, drift: float) -> None:
    t, path = encoders(20.0)
    found = path_shift(t, path, *frames(20.0, delay, drift, white(1), map_error=0.01))
    assert found.delay == pytest.approx(true_delay(delay, drift, found.middle), abs=1e-4)
    assert found.rate == pytest.approx(drift, abs=10e-6)
    assert found.delay_half < 5e-5 and found.rate_half < 10e-6


def test_a_minute_of_a_bad_crystal_comes_back() -> None:
    t, path = encoders(60.0)
    found = path_shift(t, path, *frames(60.0, 0.03, 150e-6, white(2)))
    assert found.rate == pytest.approx(150e-6, abs=3e-6)
    assert found.delay == pytest.approx(true_delay(0.03, 150e-6, found.middle), abs=1e-4)


def test_a_clock_that_began_at_another_time_is_found_about_its_offset() -> None:
    t, path = encoders(10.0)
    found = path_shift(t, path, *frames(10.0, 4321.017, 20e-6, white(3)), about=4321.0)
    assert found.delay == pytest.approx(true_delay(4321.017, 20e-6, found.middle), abs=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize(("correlation", "outliers"), [(0.8, 0.0), pytest.param(0.5, 0.03, marks=pytest.mark.long)])
def test_intervals_hold_the_truth_as_often_as_they_say(correlation: float, outliers: float) -> None:
    t, path = encoders(12.0)
    held, random = [], np.random.default_rng(7)
    for _ in range(40):
        noise = correlated_noise(random, 4e-4, correlation)
        noise[random.random(len(noise)) < outliers] += 0.03
        found = path_shift(t, path, *frames(12.0, 0.011, 30e-6, noise))
        off = found.delay - true_delay(0.011, 30e-6, found.middle)
        held.append((abs(off) < found.delay_half, abs(found.rate - 30e-6) < found.rate_half))
    share = np.mean(held, axis=0)
    assert (share >= 0.85).all(), share  # of 40 at 95 %: 34 at least, 99 times of 100


def test_correlated_noise_makes_intervals_wider() -> None:
    t, path = encoders(12.0)
    random = np.random.default_rng(3)
    halves = [
        path_shift(t, path, *frames(12.0, 0.0, 0.0, correlated_noise(random, 4e-4, one))).delay_half
        for one in (0.0, 0.9)
    ]
    assert halves[1] > 1.5 * halves[0]


@pytest.mark.parametrize(
    ("t", "path", "stamps", "places", "why"),
    [
        (*encoders(9.0), *frames(9.0, 0.0, 0.0, np.nan * NONE), "the mallet is not seen"),
        (*encoders(9.0), *(one[:290] for one in frames(9.0, 0.0, 0.0, NONE)), "overlap for 2.5 s; expected 4 s"),
        (encoders(9.0)[0], np.full((4500, 2), 0.4), *frames(9.0, 0.0, 0.0, NONE), "the mallet hardly moves"),
        (*encoders(9.0), *frames(9.0, 30.0, 0.0, NONE), "hardly overlap in time"),
        (*(one[:3] for one in encoders(9.0)), *frames(9.0, 0.0, 0.0, NONE), "hardly recorded"),
    ],
)
def test_what_the_data_cannot_tell_is_said(t, path, stamps, places, why) -> None:
    with pytest.raises(NotDeterminedError, match=why):
        path_shift(t, path, stamps, places)


def test_holes_in_the_path_are_left_out() -> None:
    t, path = encoders(12.0)
    kept = (t % 2.0) > 0.3
    found = path_shift(t[kept], path[kept], *frames(12.0, 0.02, 0.0, white(5)))
    assert found.delay == pytest.approx(0.02, abs=1e-4)
