"""Errors that hang together: drawn by a recursion, and judged by the density of what polynomials cannot explain."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import null_space
from scipy.stats import multivariate_normal

from sim2real.diagnose.glide.memory import FRAMES, SHARES, Memory, Stretch, remembered
from sim2real.diagnose.pieces import cut
from sim2real.diagnose.split import glides_of
from sim2real.recording import read_recording
from tests.reality.cases import FILM
from tests.reality.law import Law
from tests.reality.record import make_recording

PERIOD, ORDER = 1.0 / 120.0, 4


def drawn(rng: np.random.Generator, glides: int, share: float, time: float, scale: float = 1.0) -> list[Stretch]:
    """Glides of 24 to 60 frames along a parabola, some of them missing; errors are `scale` times what is assumed."""
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
        found.append(Stretch(t[seen], (path + scale * std * np.array(rows))[seen], std[seen]))
    return found


def test_memory_and_size_of_errors_are_found() -> None:
    found = remembered(drawn(np.random.default_rng(3), 150, 0.75, 3.0 * PERIOD, 1.4), ORDER, PERIOD)
    assert found.share == pytest.approx(0.75, abs=0.16) and found.time == pytest.approx(3.0 * PERIOD)
    assert found.scale == pytest.approx(1.4, rel=0.05)


def test_white_errors_have_none() -> None:
    rng = np.random.default_rng(4)
    assert [remembered(drawn(rng, 40, 0.0, 1.0), ORDER, PERIOD) for _ in range(30)] == 30 * [Memory()]


def test_without_glides_there_is_none() -> None:
    assert remembered([], ORDER, PERIOD) == Memory()


def test_the_likeliest_is_taken() -> None:
    """By the density of contrasts, combinations of frames that are zero for any polynomial of the order, at the size of
    each glide's own."""
    glides = drawn(np.random.default_rng(5), 30, 0.6, 1.5 * PERIOD)
    found = remembered(glides, ORDER, PERIOD)
    likelihoods, sizes = {}, {}
    for share in SHARES:
        for many in FRAMES:
            tried, total, squares, counts = Memory(share, many * PERIOD), 0.0, [], []
            for glide in glides:
                contrasts = null_space(np.vander((glide.t - glide.t[0]) / np.ptp(glide.t), ORDER + 1).T)
                covariance = contrasts.T @ tried.covariance(glide.t) @ contrasts
                seen = contrasts.T @ (glide.place / glide.std)
                squares.append(float(np.sum(seen * np.linalg.solve(covariance, seen))) / seen.size)
                counts.append(seen.size)
                total += float(multivariate_normal(cov=covariance * squares[-1]).logpdf(seen.T).sum())
            likelihoods[share, tried.time] = total
            sizes[share, tried.time] = float(np.sqrt(np.average(squares, weights=counts)))
    best = max(likelihoods, key=lambda one: likelihoods[one])
    assert (found.share, found.time) == best and found.scale == pytest.approx(sizes[best])


def test_rough_glides_do_not_decide() -> None:
    """Of a tenth of the glides, pushed by a hand, errors are thirty times as large and slow."""
    rng = np.random.default_rng(6)
    found = remembered([*drawn(rng, 60, 0.0, 1.0), *drawn(rng, 6, 0.9, 3.0 * PERIOD, 30.0)], ORDER, PERIOD)
    assert found.scale < 1.2 and found.share < 0.5


@pytest.mark.parametrize("place_error", [0.0, FILM.place_error])
def test_glides_of_a_calibrated_camera_alone_have_one(tmp_path: Path, place_error: float) -> None:
    make_recording(tmp_path / "film", Law(), "launches", 1, 30.0, replace(FILM, place_error=place_error))
    recording = read_recording(tmp_path / "film")
    data = glides_of(recording, cut(recording))
    (memory,) = data.memories
    assert data.place_std == (place_error,) and (memory.share > 0.0) == (place_error > 0.0)
    assert np.median(data.std) == pytest.approx(FILM.noise, rel=0.15)
