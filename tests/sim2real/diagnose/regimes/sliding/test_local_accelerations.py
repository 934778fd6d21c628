"""Accelerations of windows of glides against parabolas and noise made by hand."""

from dataclasses import replace

import numpy as np
import pytest

from sim2real.diagnose.regimes.sliding.data import GlideData
from sim2real.diagnose.regimes.sliding.local_accelerations import acceleration_windows
from sim2real.diagnose.sensor_noise.autocorrelated import AutocorrelatedNoise
from sim2real.diagnose.sensor_noise.model import SensorNoise
from sim2real.study.independent_table.recorder import film

RATE, NOISE = 100.0, 0.0005


def _glides(durations, accelerations, rng=None) -> GlideData:
    t, place, first = [], [], [0]
    for k, (lasts, (ax, ay)) in enumerate(zip(durations, accelerations, strict=True)):
        u = np.arange(round(lasts * RATE)) / RATE
        t.append(10.0 * k + u)
        place.append(np.stack([0.3 + 0.9 * u + 0.5 * ax * u**2, 0.2 - 0.4 * u + 0.5 * ay * u**2], axis=1))
        first.append(first[-1] + len(u))
    places = np.concatenate(place)
    places = places if rng is None else places + rng.normal(0.0, NOISE, places.shape)
    count = len(durations)
    std = np.full(places.shape, NOISE)
    numbers = np.arange(count)
    return GlideData(np.concatenate(t), places, std, np.array(first), numbers, 0 * numbers, np.full(count, np.nan))


def test_a_parabola_has_its_acceleration_everywhere():
    data = _glides([0.4, 2.1], [(0.1, -0.2), (0.03, 0.05)])
    windows = acceleration_windows(data)
    assert windows.of(data.place) == pytest.approx(np.array([(0.1, -0.2)] + 3 * [(0.03, 0.05)]))


def test_windows_end_with_their_glides():
    data = _glides([0.4, 2.1], [(0.0, 0.0)] * 2)
    windows = acceleration_windows(data)
    assert windows.first[:2].tolist() == [0, 40] and len(windows.first) == 4
    assert windows.mean(data.t)[0] == pytest.approx(0.195)


def test_the_noise_is_what_it_says():
    data = _glides([0.7] * 400, [(0.0, 0.0)] * 400, np.random.default_rng(1))
    windows = acceleration_windows(data)
    assert windows.of(data.place).std(axis=0) == pytest.approx(windows.std[0], rel=0.08)


def test_autocorrelated_noise_is_what_it_says():
    data, rng = _glides([0.7] * 400, [(0.0, 0.0)] * 400), np.random.default_rng(2)
    drawn = NOISE * np.concatenate([film.noise(rng, t, 0.02, 0.75) for t in np.split(data.t, data.first[1:-1])])
    windows = acceleration_windows(replace(data, noise=(SensorNoise(autocorrelation=AutocorrelatedNoise(0.75, 0.02)),)))
    assert windows.of(data.place + drawn).std(axis=0) == pytest.approx(windows.std[0], rel=0.08)
