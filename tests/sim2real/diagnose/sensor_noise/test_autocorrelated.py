"""Autocorrelated errors: drawn recursively, and their restricted likelihood computed from contrasts."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import null_space
from scipy.stats import multivariate_normal

from sim2real.diagnose.sensor_noise.autocorrelated import (
    AutocorrelatedNoise,
    Excerpt,
    estimate_autocorrelation,
)
from sim2real.diagnose.sensor_noise.tuned import SENSOR_NOISE
from sim2real.diagnose.split import glides_of
from sim2real.recording.folder import read_recording
from sim2real.segmentation.segments import segment
from sim2real.study.independent_table.cases import FILM
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.recorder.camera import Camera
from sim2real.study.independent_table.recorder.record import make_recording

PERIOD, ORDER = 1.0 / 120.0, 4


def drawn(rng: np.random.Generator, glides: int, share: float, time: float, scale: float = 1.0) -> list[Excerpt]:
    """Return glides of 24 to 60 frames along a parabola; frames are missing; errors have `scale`."""
    found = []
    for frames in rng.integers(24, 60, glides):
        slow = rng.normal(size=2)
        rows = []
        for _ in range(frames):
            rows.append(np.sqrt(share) * slow + np.sqrt(1.0 - share) * rng.normal(size=2))
            fades = np.exp(-PERIOD / time)
            slow = fades * slow + np.sqrt(1.0 - fades**2) * rng.normal(size=2)
        t = np.arange(frames) * PERIOD
        seen = rng.random(frames) > 0.1
        seen[[0, -1]] = True
        path = np.stack([0.3 * t - 0.04 * t**2, -0.09 * t + 0.5], axis=1)
        std = np.tile([1e-5, 3e-5], (frames, 1))
        found.append(Excerpt(t[seen], (path + scale * std * np.array(rows))[seen], std[seen]))
    return found


def test_correlation_and_scale_are_estimated() -> None:
    found = estimate_autocorrelation(drawn(np.random.default_rng(3), 150, 0.75, 3.0 * PERIOD, 1.4), ORDER, PERIOD)
    assert found.share == pytest.approx(0.75, abs=0.16) and found.time == pytest.approx(3.0 * PERIOD)
    assert found.scale == pytest.approx(1.4, rel=0.05)


@pytest.mark.slow
def test_white_errors_have_none() -> None:
    rng = np.random.default_rng(4)
    assert [estimate_autocorrelation(drawn(rng, 40, 0.0, 1.0), ORDER, PERIOD) for _ in range(30)] == 30 * [
        AutocorrelatedNoise()
    ]


def test_without_glides_there_is_none() -> None:
    assert estimate_autocorrelation([], ORDER, PERIOD) == AutocorrelatedNoise()


def test_the_maximum_likelihood_is_found() -> None:
    """The likelihood is the density of contrasts, which are zero for any polynomial of the order, at each glide's own
    scale."""
    glides = drawn(np.random.default_rng(5), 30, 0.6, 1.5 * PERIOD)
    found = estimate_autocorrelation(glides, ORDER, PERIOD)
    likelihoods, sizes = {}, {}
    for share in SENSOR_NOISE.shares:
        for many in SENSOR_NOISE.correlation_frames:
            tried, total, squares, counts = AutocorrelatedNoise(share, many * PERIOD), 0.0, [], []
            for glide in glides:
                contrasts = null_space(np.vander((glide.t - glide.t[0]) / np.ptp(glide.t), ORDER + 1).T)
                covariance = contrasts.T @ tried.covariance(glide.t) @ contrasts
                rest = contrasts.T @ (glide.place / glide.std)
                squares.append(float(np.sum(rest * np.linalg.solve(covariance, rest))) / rest.size)
                counts.append(rest.size)
                total += float(multivariate_normal(cov=covariance * squares[-1]).logpdf(rest.T).sum())
            likelihoods[share, tried.time] = total
            sizes[share, tried.time] = float(np.sqrt(np.average(squares, weights=counts)))
    best = max(likelihoods, key=lambda one: likelihoods[one])
    assert (found.share, found.time) == best and found.scale == pytest.approx(sizes[best])


def test_outlying_glides_do_not_dominate() -> None:
    """A tenth of the glides, pushed by a hand, has thirty times larger and slow errors."""
    rng = np.random.default_rng(6)
    found = estimate_autocorrelation(
        [*drawn(rng, 60, 0.0, 1.0), *drawn(rng, 6, 0.9, 3.0 * PERIOD, 30.0)], ORDER, PERIOD
    )
    assert found.scale < 1.2 and found.share < 0.5


@pytest.mark.parametrize("place_error", [0.0, FILM.place_error])
def test_glides_of_any_camera_have_autocorrelation(tmp_path: Path, place_error: float) -> None:
    make_recording(tmp_path / "film", Law(), "launches", 1, 30.0, replace(FILM, place_error=place_error))
    recording = read_recording(tmp_path / "film")
    data = glides_of(recording, segment(recording))
    (noise,) = data.noise
    assert noise.map_error_std == place_error and noise.calibrated == (place_error > 0.0)
    assert noise.autocorrelation.share > 0.5
    assert np.median(data.std) == pytest.approx(FILM.noise, rel=0.15)


def test_white_noise_of_an_uncalibrated_camera_stays_white(tmp_path: Path) -> None:
    make_recording(tmp_path / "film", Law(tilt_x=0.02), "launches", 1, 30.0, Camera(noise=6e-4), dt=5e-5)
    recording = read_recording(tmp_path / "film")
    (noise,) = glides_of(recording, segment(recording)).noise
    assert noise.autocorrelation == AutocorrelatedNoise()
