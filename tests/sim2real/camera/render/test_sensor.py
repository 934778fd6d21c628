"""Blur keeps light where it is, and noise is as stated."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.camera.render.box import Box
from sim2real.camera.render.sensor import PixelNoise, Sensor

BOX = Box(0, 0, 40, 60)


def test_blur_keeps_energy_and_middle_and_adds_its_variance() -> None:
    light = np.zeros((41, 61))
    light[18, 33] = 200.0
    spread = Sensor(blur=0.9).spread(light)
    columns = np.arange(61)
    profile = spread.sum(axis=0) / spread.sum()
    assert spread.sum() == pytest.approx(200.0)
    assert profile @ columns == pytest.approx(33.0)
    assert profile @ (columns - 33) ** 2 == pytest.approx(0.81, rel=5e-3)
    assert (Sensor(blur=0.0).spread(light) == light).all()


@pytest.mark.parametrize("level", [12.0, 90.0, 200.0])
def test_noise_has_the_stated_variance(level: float) -> None:
    sensor, noise = Sensor(read_noise=1.5, shot_noise=0.03), PixelNoise(BOX, 1)
    pictures = np.stack([sensor.levels(np.full(BOX.shape, level), noise.of(k, BOX)) for k in range(40)]).astype(float)
    assert pictures.mean() == pytest.approx(level, abs=0.05)
    assert pictures.var(axis=0).mean() == pytest.approx(1.5**2 + 0.03 * level + 1 / 12, rel=0.05)  # and rounding's


def test_noise_of_pictures_in_a_row_and_of_neighbours_is_unrelated() -> None:
    noise = PixelNoise(BOX, 2)
    fields = np.stack([noise.of(k, BOX) for k in range(30)])
    flat = fields.reshape(30, -1)
    between = np.corrcoef(flat) - np.eye(30)
    assert np.abs(between).max() < 0.12  # 2400 pixels: 0.02 each
    assert abs((fields[:, 1:] * fields[:, :-1]).mean()) < 0.01


def test_saturated_light_is_white_and_none_is_black() -> None:
    levels = Sensor(read_noise=0.0, shot_noise=0.0).levels(np.array([[-3.0, 254.6, 300.0]]), np.zeros((1, 3)))
    assert levels.tolist() == [[0, 255, 255]]


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_levels_are_to_the_last_bit_those_of_sums_of_whole_arrays(kind: type) -> None:
    sensor, noise = Sensor(), PixelNoise(BOX, 3).of(7, BOX)
    light = np.random.default_rng(1).uniform(-5.0, 270.0, BOX.shape).astype(kind)
    deviation = np.sqrt(sensor.read_noise**2 + sensor.shot_noise * np.maximum(light, 0.0))
    expected = np.clip(np.rint(light + deviation * noise), 0, 255).astype(np.uint8)
    assert (sensor.levels(light, noise) == expected).all() and expected.min() == 0 and expected.max() == 255
