"""What places err by: white again after it, however it hangs together, and apart where it must be."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sim2real.diagnose.glide.data import GlideData
from sim2real.diagnose.glide.errors import Errors
from sim2real.diagnose.glide.memory import Memory
from sim2real.diagnose.glide.place_error import modes

SIZE, NOISE, FRAMES, GLIDES = np.array([2.0, 1.0]), 2e-5, 30, 8
STATED = 1.5e-4  # m


def glides(memory: Memory, place_std: float) -> GlideData:
    rng = np.random.default_rng(1)
    count = GLIDES * FRAMES
    return GlideData(
        np.arange(count) / 120.0, rng.uniform((0.0, 0.0), SIZE, (count, 2)), np.full((count, 2), NOISE),
        np.arange(GLIDES + 1) * FRAMES, np.arange(GLIDES), np.zeros(GLIDES, int), np.full(GLIDES, np.nan),
        (memory,), (place_std,),
    )  # fmt: skip


def test_noise_that_fades_is_white_after() -> None:
    memory = Memory(0.8, 0.02)
    data = glides(memory, 0.0)
    root = np.linalg.cholesky(memory.covariance(data.t[:FRAMES]))
    drawn = NOISE * np.einsum("ij,gjad->giad", root, np.random.default_rng(2).normal(size=(GLIDES, FRAMES, 2, 4000)))
    white = Errors(data, SIZE).white(drawn.reshape(-1, 2, 4000)).reshape(-1, 4000)
    np.testing.assert_allclose(white @ white.T / 4000, np.eye(len(white)), atol=0.1)


def test_what_the_calibration_errs_by_is_white_after() -> None:
    """Fields and noise of 6,000 recordings: each residual has unit variance, and no two hang together."""
    data = glides(Memory(), STATED)
    errors = Errors(data, SIZE)
    rng = np.random.default_rng(3)
    shared = errors.white(errors.modes(data.place)).reshape(2 * len(data.t), -1)
    drawn = shared @ rng.normal(size=(shared.shape[1], 6000)) + rng.normal(size=(len(shared), 6000))
    white = errors.allowing(shared, drawn)
    np.testing.assert_allclose(white @ white.T / 6000, np.eye(len(white)), atol=0.09)


def test_a_calibration_that_states_no_error_has_none() -> None:
    data = glides(Memory(), 0.0)
    errors = Errors(data, SIZE)
    assert errors.modes(data.place).shape == (len(data.t), 2, 0)
    rows = np.ones((2 * len(data.t), 2))
    assert errors.allowing(np.zeros((len(rows), 0)), rows) is rows


def test_of_two_recordings_each_has_what_it_states() -> None:
    first, second = glides(Memory(), 0.0), glides(Memory(), STATED)
    both = replace(first, recording=np.repeat([0, 1], GLIDES // 2), memories=(Memory(),) * 2, place_std=(0.0, STATED))
    found = Errors(both, SIZE).modes(both.place)
    half = GLIDES // 2 * FRAMES
    assert not found[:half].any()
    np.testing.assert_array_equal(found[half:], modes(second.place, SIZE, np.full(len(second.t), STATED))[half:])


def test_two_calibrations_err_apart() -> None:
    """Recordings that state two sizes were calibrated twice; of one size, they share its error."""
    first, half = glides(Memory(), STATED), GLIDES // 2 * FRAMES
    both = replace(first, recording=np.repeat([0, 1], GLIDES // 2), memories=(Memory(),) * 2)
    shared = Errors(replace(both, place_std=(STATED, STATED)), SIZE).modes(both.place)
    np.testing.assert_array_equal(shared, modes(first.place, SIZE, np.full(len(first.t), STATED)))
    own = Errors(replace(both, place_std=(STATED, 1.1 * STATED)), SIZE).modes(both.place)
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
