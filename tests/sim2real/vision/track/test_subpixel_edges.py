"""Edges of pictures that are drawn here by the error function, as a lens blurs a step."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ndtr

from sim2real.vision.track.subpixel_edges import find_edge_points

SIZE = 60


def half_plane(angle: float, away: float, blur: float, noise: float = 0.0) -> np.ndarray:
    """Bright where a pixel is nearer than `away` along a direction, from the picture's middle."""
    v, u = np.mgrid[0:SIZE, 0:SIZE] - SIZE / 2.0
    depth = away - (np.cos(angle) * u + np.sin(angle) * v)
    levels = 20.0 + 100.0 * ndtr(depth / blur) + np.random.default_rng(0).normal(0.0, noise, (SIZE, SIZE))
    return levels.round().astype(np.uint8)


def outline_of(image: np.ndarray) -> np.ndarray:
    """Bright pixels beside dark ones, by hand."""
    bright = image > 70
    beside = np.zeros_like(bright)
    beside[1:-1, 1:-1] = ~(bright[2:, 1:-1] & bright[:-2, 1:-1] & bright[1:-1, 2:] & bright[1:-1, :-2])
    return np.argwhere(bright & beside)[:, ::-1]


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.2, 2.5, -2.0])
@pytest.mark.parametrize("blur", [0.7, 1.2])
def test_edges_are_where_the_step_is(angle, blur):
    rim = find_edge_points(
        half_plane(angle, 3.3, blur), outline_of(half_plane(angle, 3.3, blur)), lambda pixels: pixels
    )
    out = np.array([np.cos(angle), np.sin(angle)])
    along = (rim.places - SIZE / 2.0) @ out
    assert len(rim) > 30 and np.abs(along - 3.3).max() < 0.12 and abs(along.mean() - 3.3) < 0.06  # bilinear levels
    assert (rim.steps @ out).min() > 0.99


def test_noise_moves_an_edge_by_hundredths_of_a_pixel():
    image = half_plane(0.4, -2.6, 0.9, noise=1.0)
    along = (find_edge_points(image, outline_of(image), lambda p: p).places - SIZE / 2.0) @ (np.cos(0.4), np.sin(0.4))
    assert abs(along.mean() + 2.6) < 0.06 and along.std() < 0.1


def test_no_edge_is_clear_on_a_flat_ground_nor_at_the_border_nor_off_the_map():
    flat = np.full((SIZE, SIZE), 90, np.uint8)
    assert len(find_edge_points(flat, np.array([[30, 30], [20, 20]]), lambda p: p)) == 0
    image = half_plane(0.0, 0.0, 0.8)
    faint = (20.0 + 0.06 * (image - 20.0)).round().astype(np.uint8)  # of six grey levels
    assert (
        len(find_edge_points(image, outline_of(image), lambda p: p))
        > 30
        == len(find_edge_points(faint, outline_of(image), lambda p: p)) + 30
    )
    assert len(find_edge_points(image, np.array([[29, 1], [29, SIZE - 2]]), lambda p: p)) == 0
    assert len(find_edge_points(image, outline_of(image), lambda p: np.full_like(p, np.nan))) == 0
