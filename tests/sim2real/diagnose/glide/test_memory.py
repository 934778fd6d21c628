"""Errors that hang together: drawn by a recursion, and judged by the density of what polynomials cannot explain."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import null_space
from scipy.stats import multivariate_normal

from sim2real.diagnose.glide.memory import FRAMES, SHARES, Memory, remembered

PERIOD, ORDER = 1.0 / 120.0, 4


def drawn(rng: np.random.Generator, glides: int, share: float, time: float, scale: float = 1.0):
    """Times and errors of glides of 24 to 60 frames about a parabola, some frames missing."""
    times, places = [], []
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
        path = np.stack([300.0 * t - 40.0 * t**2, -90.0 * t + 5.0], axis=1)
        times.append(t[seen])
        places.append((path + scale * np.array(rows))[seen])
    return times, places


def test_memory_and_size_of_errors_are_found() -> None:
    times, places = drawn(np.random.default_rng(3), 150, 0.75, 3.0 * PERIOD, 1.4)
    found = remembered(times, places, ORDER, PERIOD)
    assert found.share == pytest.approx(0.75, abs=0.16) and found.time == pytest.approx(3.0 * PERIOD)
    assert found.scale == pytest.approx(1.4, rel=0.05)


def test_white_errors_have_none() -> None:
    rng = np.random.default_rng(4)
    assert [remembered(*drawn(rng, 40, 0.0, 1.0), ORDER, PERIOD) for _ in range(30)] == 30 * [Memory()]


def test_without_glides_there_is_none() -> None:
    assert remembered([], [], ORDER, PERIOD) == Memory()


def test_the_likeliest_is_taken() -> None:
    """By the density of contrasts, combinations of frames that are zero for any polynomial of the order, at the size of
    each glide's own."""
    times, places = drawn(np.random.default_rng(5), 30, 0.6, 1.5 * PERIOD)
    found = remembered(times, places, ORDER, PERIOD)
    likelihoods, sizes = {}, {}
    for share in SHARES:
        for many in FRAMES:
            tried, total, squares = Memory(share, many * PERIOD), 0.0, []
            for t, place in zip(times, places, strict=True):
                contrasts = null_space(np.vander((t - t[0]) / np.ptp(t), ORDER + 1).T)
                covariance = contrasts.T @ tried.covariance(t) @ contrasts
                seen = contrasts.T @ place
                squares.append(float(np.sum(seen * np.linalg.solve(covariance, seen))) / seen.size)
                total += float(multivariate_normal(cov=covariance * squares[-1]).logpdf(seen.T).sum())
            likelihoods[share, tried.time], sizes[share, tried.time] = total, float(np.sqrt(np.median(squares)))
    best = max(likelihoods, key=lambda one: likelihoods[one])
    assert (found.share, found.time) == best and found.scale == pytest.approx(sizes[best])


def test_rough_glides_do_not_decide() -> None:
    """Of a tenth of the glides, pushed by a hand, errors are thirty times as large and slow."""
    rng = np.random.default_rng(6)
    calm, rough = drawn(rng, 60, 0.0, 1.0), drawn(rng, 6, 0.9, 3.0 * PERIOD, 30.0)
    found = remembered(calm[0] + rough[0], calm[1] + rough[1], ORDER, PERIOD)
    assert found.scale < 1.2 and found.share < 0.5
