"""The covariance of positions: errors drawn from it are white after whitening."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sim2real.diagnose.regimes.sliding.data import GlideData
from sim2real.diagnose.sensor_noise.autocorrelated import AutocorrelatedNoise
from sim2real.diagnose.sensor_noise.covariance import PositionCovariance
from sim2real.diagnose.sensor_noise.map_error import modes
from sim2real.diagnose.sensor_noise.model import SensorNoise

SIZE, NOISE, FRAMES, GLIDES = np.array([2.0, 1.0]), 2e-5, 30, 8
STATED = 1.5e-4  # m


def glides(autocorrelation: AutocorrelatedNoise, map_error_std: float) -> GlideData:
    rng = np.random.default_rng(1)
    count = GLIDES * FRAMES
    return GlideData(
        np.arange(count) / 120.0, rng.uniform((0.0, 0.0), SIZE, (count, 2)), np.full((count, 2), NOISE),
        np.arange(GLIDES + 1) * FRAMES, np.arange(GLIDES), np.zeros(GLIDES, int), np.full(GLIDES, np.nan),
        (SensorNoise(autocorrelation=autocorrelation, map_error_std=map_error_std),),
    )  # fmt: skip


def covariance_of(data: GlideData) -> PositionCovariance:
    return PositionCovariance(data.t, data.std, data.first, data.noise_of_glide, SIZE)


def recordings(data: GlideData, *map_error_std: float) -> GlideData:
    """Return the glides divided in two recordings with these map errors."""
    noise = tuple(SensorNoise(map_error_std=std) for std in map_error_std)
    return replace(data, recording=np.repeat([0, 1], GLIDES // 2), noise=noise)


def test_autocorrelated_noise_is_white_after() -> None:
    noise = AutocorrelatedNoise(0.8, 0.02)
    data = glides(noise, 0.0)
    root = np.linalg.cholesky(noise.covariance(data.t[:FRAMES]))
    drawn = NOISE * np.einsum("ij,gjad->giad", root, np.random.default_rng(2).normal(size=(GLIDES, FRAMES, 2, 4000)))
    white = covariance_of(data).white(drawn.reshape(-1, 2, 4000)).reshape(-1, 4000)
    np.testing.assert_allclose(white @ white.T / 4000, np.eye(len(white)), atol=0.1)


def test_the_map_error_is_white_after() -> None:
    """Fields and noise of 6,000 recordings: each residual has unit variance, and no two are correlated."""
    data = glides(AutocorrelatedNoise(), STATED)
    errors = covariance_of(data)
    rng = np.random.default_rng(3)
    shared = errors.white(errors.modes(data.place)).reshape(2 * len(data.t), -1)
    drawn = shared @ rng.normal(size=(shared.shape[1], 6000)) + rng.normal(size=(len(shared), 6000))
    white = errors.allowing(shared, drawn)
    np.testing.assert_allclose(white @ white.T / 6000, np.eye(len(white)), atol=0.09)


def test_a_camera_that_is_not_calibrated_has_no_modes() -> None:
    data = glides(AutocorrelatedNoise(), 0.0)
    errors = covariance_of(data)
    assert errors.modes(data.place).shape == (len(data.t), 2, 0)
    rows = np.ones((2 * len(data.t), 2))
    assert errors.allowing(np.zeros((len(rows), 0)), rows) is rows


def test_each_of_two_recordings_has_its_stated_error() -> None:
    first, second = glides(AutocorrelatedNoise(), 0.0), glides(AutocorrelatedNoise(), STATED)
    both = recordings(first, 0.0, STATED)
    found = covariance_of(both).modes(both.place)
    half = GLIDES // 2 * FRAMES
    assert not found[:half].any()
    np.testing.assert_array_equal(found[half:], modes(second.place, SIZE, np.full(len(second.t), STATED))[half:])


def test_two_calibrations_have_independent_errors() -> None:
    """Recordings that state different sizes have independent errors; those with the same size share one."""
    first, half = glides(AutocorrelatedNoise(), STATED), GLIDES // 2 * FRAMES
    shared = covariance_of(recordings(first, STATED, STATED)).modes(first.place)
    np.testing.assert_array_equal(shared, modes(first.place, SIZE, np.full(len(first.t), STATED)))
    own = covariance_of(recordings(first, STATED, 1.1 * STATED)).modes(first.place)
    covariance = np.einsum("nak,mbk->nmab", own, own)
    np.testing.assert_array_equal(covariance[:half, half:], 0.0)
    np.testing.assert_allclose(
        covariance[half:, half:], 1.21 * np.einsum("nak,mbk->nmab", shared[half:], shared[half:]), atol=1e-20
    )


def test_the_field_is_as_large_as_stated_and_ends_with_the_table() -> None:
    rng = np.random.default_rng(5)
    place = rng.uniform((0.0, 0.0), SIZE, (20000, 2))
    found = modes(place, SIZE, np.full(len(place), STATED))
    assert np.sqrt((found**2).sum(axis=2).mean(axis=0)) == pytest.approx(2 * [STATED], rel=0.03)
    border = modes(np.array([[2.0, 0.5], [2.3, 0.5]]), SIZE, np.full(2, STATED))
    np.testing.assert_array_equal(border[0], border[1])
