"""The exponentials of a gantry's modes against the library's."""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.physics.gantry.decay import decay, fade


def test_decay_is_the_exponential():
    for exponent in np.concatenate([np.linspace(0.0, 3.0, 3001), [20.0, 700.0]]):
        assert abs(decay(exponent) / math.exp(-exponent) - 1.0) < 3.5e-15


def test_decay_begins_at_one():
    assert decay(0.0) == 1.0


def test_fade_ends_at_nothing():
    for exponent in np.linspace(0.0, 60.0, 601):
        assert abs(fade(1500.0, exponent / 1500.0) - math.exp(-exponent)) < 1e-15
    assert fade(1500.0, 0.1) == 0.0
