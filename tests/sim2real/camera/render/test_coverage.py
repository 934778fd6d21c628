"""Exact coverage against samples of each pixel (matplotlib says which are inside), and against areas in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest
from matplotlib.path import Path
from scipy.integrate import quad

from sim2real.camera.render.box import Box
from sim2real.camera.render.coverage import coverage, cut

SAMPLES = 16


def star(seed: int, corners: int = 11) -> np.ndarray:
    """A polygon with sharp corners, of any winding, partly outside of BOX."""
    random = np.random.default_rng(seed)
    angle = np.sort(random.uniform(0.0, 2.0 * np.pi, corners)) * random.choice((-1, 1))
    radius = random.uniform(2.0, 19.0, corners)
    return np.stack([12.3 + radius * np.cos(angle), 9.1 + radius * np.sin(angle)], axis=1)


BOX = Box(-3, 2, 21, 29)


@pytest.mark.parametrize("seed", range(8))
def test_as_sampled_with_sixteen_by_sixteen_in_each_pixel(seed: int) -> None:
    outline = star(seed)
    if seed == 0:
        outline = np.array([(4.0, 3.5), (4.0, 8.5), (9.5, 8.5), (9.5, 3.5)])  # edges along borders of pixels
    rows, columns = BOX.shape
    fine = (np.arange(rows * SAMPLES) + 0.5) / SAMPLES - 0.5 + BOX.top
    across = (np.arange(columns * SAMPLES) + 0.5) / SAMPLES - 0.5 + BOX.left
    v, u = np.meshgrid(fine, across, indexing="ij")
    inside = Path(outline).contains_points(np.stack([u.ravel(), v.ravel()], axis=1)).reshape(v.shape)
    sampled = inside.reshape(rows, SAMPLES, columns, SAMPLES).mean(axis=(1, 3))
    error = coverage(outline, BOX) - sampled
    assert np.abs(error).max() < 2.0 / SAMPLES  # two edges, each off by half a row of samples at most
    assert abs(error.sum()) < 0.003 * max(sampled.sum(), 100.0)


def test_the_whole_area_is_covered_and_balanced() -> None:
    outline = star(3)
    x, y = outline.T
    x_next, y_next = np.roll(outline, -1, axis=0).T
    cross = x * y_next - x_next * y
    area, middle = 0.5 * cross.sum(), ((x + x_next) * cross).sum() / 6.0
    box = Box.around(outline)
    shares = coverage(outline, box)
    assert shares.sum() == pytest.approx(abs(area), rel=1e-12)
    assert (shares.sum(axis=0) @ np.arange(box.left, box.right)) == pytest.approx(middle * np.sign(area), rel=2e-3)


def test_a_row_of_a_circle_has_the_chords_area() -> None:
    radius, u, v = 9.37, 20.21, 14.68
    angle = 2.0 * np.pi * np.arange(20_000) / 20_000
    outline = np.stack([u + radius * np.cos(angle), v + radius * np.sin(angle)], axis=1)
    box = Box.around(outline)
    rows = coverage(outline, box).sum(axis=1)

    def chord(y: float) -> float:
        return 2.0 * math.sqrt(max(radius**2 - (y - v) ** 2, 0.0))

    expected = [quad(chord, row - 0.5, row + 0.5, points=[v - radius, v + radius])[0] for row in range(*box[::2])]
    np.testing.assert_allclose(rows, expected, atol=2e-5)


def test_a_box_cuts_exactly() -> None:
    outline = star(5)
    whole, part = Box(-20, -20, 40, 40), Box(2, 5, 11, 14)
    np.testing.assert_allclose(coverage(outline, part), coverage(outline, whole)[part.within(whole)], atol=1e-12)
    assert not coverage(outline + 100.0, part).any()
    assert (coverage(np.array([(-9, -9), (99, -9), (99, 99), (-9, 99.0)]), part) == 1.0).all()


def cut_by_numpy(corners: np.ndarray, longest: float) -> tuple[np.ndarray, np.ndarray]:
    edge = np.roll(corners, -1, axis=0) - corners
    pieces = np.maximum(np.ceil(np.sqrt((edge**2).sum(axis=1)) / longest), 1.0).astype(np.intp)
    step = np.repeat(edge / pieces[:, None], pieces, axis=0)
    number = np.arange(len(step)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    return np.repeat(corners, pieces, axis=0) + number[:, None] * step, step


def coverage_by_numpy(outline: np.ndarray, box: Box) -> np.ndarray:
    rows, columns = box.shape
    start, step = cut_by_numpy(outline - np.array([box.left - 0.5, box.top - 0.5]), 1.0)
    first, last = np.floor(start), np.floor(start + step)
    with np.errstate(divide="ignore", invalid="ignore"):
        cuts = np.where(first != last, (np.maximum(first, last) - start) / step, 1.0)
    before, after = np.minimum(*cuts.T)[:, None], np.maximum(*cuts.T)[:, None]
    points = np.stack([start, start + before * step, start + after * step, start + step], axis=1)
    begin, end = points[:, :-1].reshape(-1, 2), points[:, 1:].reshape(-1, 2)
    height, middle = end[:, 1] - begin[:, 1], 0.5 * (begin + end)
    x, row = np.clip(middle[:, 0], 0.0, columns), np.floor(middle[:, 1])
    inside = (row >= 0) & (row < rows) & (height != 0.0)
    x, row, height = x[inside], row[inside], height[inside]
    place, further = (row * (columns + 2) + np.floor(x)).astype(np.intp), height * (x - np.floor(x))
    covered = np.bincount(place, height - further, rows * (columns + 2))
    covered += np.bincount(place + 1, further, rows * (columns + 2))
    return np.minimum(np.abs(covered.reshape(rows, -1).cumsum(axis=1)[:, :columns]), 1.0)


@pytest.mark.parametrize("seed", range(4))
def test_to_the_last_bit_as_with_sums_of_whole_arrays(seed: int) -> None:
    outline = star(seed)
    assert (coverage(outline, BOX) == coverage_by_numpy(outline, BOX)).all()
    for one, other in zip(cut(outline, 0.7), cut_by_numpy(outline, 0.7), strict=True):
        assert (one == other).all()
