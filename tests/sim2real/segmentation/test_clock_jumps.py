"""Clock jumps are distinguished from dropped frames, single late stamps, and jitter."""

import numpy as np
import pytest

from sim2real.segmentation.clock_jumps import clock_jumps

PERIOD, NOISE = 1 / 120, 0.0005


@pytest.fixture
def path():
    """Twenty seconds of straight motion at 0.8 m/s that reverses every 1.5 s: times (n,), places (n, 2)."""
    t = np.arange(2400) * PERIOD
    x = 0.2 + 0.8 * np.abs((t + 0.4) % 3.0 - 1.5)
    noise = np.random.default_rng(3).normal(0.0, NOISE, (len(t), 2))
    return t, np.stack([x, 0.5 * x], axis=1) + noise


@pytest.mark.parametrize("size", [0.02, 0.3, 5.0])
def test_a_leap_is_found_and_measured(path, size):
    t, place = path
    found = clock_jumps(t + size * (t >= 10.0), place)
    assert len(found) == 1
    assert found[0].t == pytest.approx(10.0, abs=2 * PERIOD)
    assert found[0].size == pytest.approx(size, abs=0.003)


def test_an_even_clock_has_none_though_the_puck_turns_round(path):
    t, place = path
    rng = np.random.default_rng(4)
    jitter = np.clip(rng.normal(0.0, 0.001, len(t)), -0.3 * PERIOD, 0.3 * PERIOD)
    assert clock_jumps(t, place) == clock_jumps(t + jitter, place) == []


def test_frames_that_were_dropped_are_no_leap(path):
    t, place = path
    kept = np.ones(len(t), bool)
    kept[300:330] = kept[700:702] = kept[1500:1900] = False
    assert clock_jumps(t[kept], place[kept]) == []


def test_one_late_stamp_is_no_leap(path):
    t, place = path
    late = t.copy()
    late[1000] += 0.9 * PERIOD
    assert clock_jumps(late, place) == []


def test_a_clock_that_leaps_while_nothing_moves_or_is_seen_tells_nothing(path):
    t, place = path
    stopped = np.full_like(place, 0.4)
    blank = place.copy()
    blank[1150:1250] = np.nan
    assert clock_jumps(t + (t >= 10.0), stopped) == clock_jumps(t + (t >= 10.0), blank) == []
