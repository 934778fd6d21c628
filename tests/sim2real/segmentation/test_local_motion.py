"""Parabolas through a few frames against numpy's least squares, and the gap at which two motions meet."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.segmentation.local_motion import best_gap, local_motion
from sim2real.segmentation.sensor_noise import Noise
from sim2real.segmentation.tuned import SEGMENTATION

NOISE = Noise(2e-4, 1e-4)


def path(frames: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Times at irregular steps [s], and noisy places (frames, 2) [m] of a braked motion."""
    random = np.random.default_rng(seed)
    t = 40.0 + np.cumsum(random.uniform(0.007, 0.01, frames))
    u = t - t[0]
    places = np.stack([0.4 + 1.8 * u - 0.3 * u**2, 0.7 - 0.6 * u + 0.1 * u**2], axis=1)
    return t, places + 2e-4 * random.standard_normal(places.shape)


@pytest.mark.parametrize("frames", [2, 3, 5, 12, 60])
def test_it_is_the_ridge_regression_of_a_parabola(frames: int) -> None:
    t, p = path(frames + 4, frames)
    at, used = float(t[3]) + 0.002, slice(2, 2 + frames)
    u = t[used] - at
    speed = np.linalg.norm(p[used][-1] - p[used][0]) / np.ptp(u)
    sigma = np.hypot(2e-4, 1e-4 * speed)
    rows = np.vstack([np.stack([np.ones_like(u), u, u * u / 2], axis=1),
                      [0.0, 0.0, sigma / SEGMENTATION.free_acceleration]])  # fmt: skip
    wanted = np.linalg.lstsq(rows, np.vstack([p[used], np.zeros(2)]), rcond=None)[0]
    spread = sigma * np.sqrt(np.diag(np.linalg.inv(rows.T @ rows)))
    found = local_motion(t, p, at, used, NOISE)
    np.testing.assert_allclose([found.place, found.velocity], wanted[:2], atol=1e-8)
    np.testing.assert_allclose([found.place_std, found.velocity_std], spread[:2], rtol=1e-6)
    assert found.rest == pytest.approx(((p[used] - rows[:-1] @ wanted) ** 2).sum(), abs=1e-14)
    assert found.frames == frames


def test_of_one_frame_the_place_alone_is_known() -> None:
    t, p = path(4, 1)
    found = local_motion(t, p, float(t[2]), slice(2, 3), NOISE)
    assert tuple(found.place) == tuple(p[2]) and found.place_std == 2e-4 and found.velocity_std == np.inf


@pytest.mark.parametrize("off", range(-5, 6))
def test_a_changepoint_is_put_where_the_motion_turns_as_far_as_gaps_are_tried(off: int) -> None:
    t, p = path(60, 7)
    turned = p.copy()
    turned[30:, 1] += 2.0 * (t[30:] - t[29] - 0.004)  # between the frames 29 and 30
    found = best_gap(t, turned, NOISE, np.zeros(59, bool), 29 + off)
    assert (found == 29) == (abs(off) <= 3)


def test_no_motion_reaches_over_a_cut() -> None:
    """What lies beyond it would fit neither motion."""
    t, p = path(60, 8)
    turned = p.copy()
    turned[30:, 1] += 2.0 * (t[30:] - t[29] - 0.004)
    turned[38:] += 0.5
    turned[:22] -= 0.5
    cuts = np.zeros(59, bool)
    cuts[[21, 37]] = True
    assert best_gap(t, turned, NOISE, cuts, 31) == 29
    cuts[30] = True  # nothing is tried on the other side of one
    assert best_gap(t, turned, NOISE, cuts, 31) != 29
