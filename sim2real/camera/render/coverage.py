"""The exact share of each pixel that an outline covers: anti-aliasing by area instead of by samples."""

from __future__ import annotations

import numpy as np

from sim2real.camera.render.box import Box


def coverage(outline: np.ndarray, box: Box) -> np.ndarray:
    """The share (rows, columns), 0 to 1, of each pixel of `box` inside the polygon `outline` (n, 2), u and v of its
    corners [pixels].

    The centre of the first pixel is at (0, 0), as in OpenCV, so pixel i reaches from i - 0.5 to i + 0.5. The polygon
    must not cross itself. By Green's theorem, edge by edge: a piece of an edge within one pixel contributes the area on
    its right in this pixel, and its height to all pixels further right in the row; a cumulative sum along the rows adds
    these up. A polygon that extends beyond the box is clipped exactly.
    """
    rows, columns = box.shape
    start, end = _in_one_pixel(outline - np.array([box.left - 0.5, box.top - 0.5]))
    height = end[:, 1] - start[:, 1]
    middle = 0.5 * (start + end)
    x = np.clip(middle[:, 0], 0.0, columns)
    row = np.floor(middle[:, 1])
    inside = (row >= 0) & (row < rows) & (height != 0.0)
    x, row, height = x[inside], row[inside], height[inside]
    column = np.floor(x)
    place = (row * (columns + 2) + column).astype(np.intp)
    further = height * (x - column)
    size = rows * (columns + 2)
    covered = np.bincount(place, height - further, size)
    covered += np.bincount(place + 1, further, size)
    shares = covered.reshape(rows, columns + 2).cumsum(axis=1)[:, :columns]
    return np.minimum(np.abs(shares), 1.0)


def cut(corners: np.ndarray, longest: float) -> tuple[np.ndarray, np.ndarray]:
    """Divide the edges of the polygon `corners` (n, k) into equal pieces no longer than `longest`: the start (m, k) of
    each piece, and the step (m, k) to its end."""
    edge = np.roll(corners, -1, axis=0) - corners
    pieces = np.maximum(np.ceil(np.sqrt((edge**2).sum(axis=1)) / longest), 1.0).astype(np.intp)
    step = np.repeat(edge / pieces[:, None], pieces, axis=0)
    number = np.arange(len(step)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    return np.repeat(corners, pieces, axis=0) + number[:, None] * step, step


def _in_one_pixel(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cut the polygon's edges at the pixels' borders, which are whole numbers here: starts (m, 2) and ends (m, 2)."""
    start, step = cut(corners, 1.0)  # crosses at most one border each way
    first, last = np.floor(start), np.floor(start + step)
    with np.errstate(divide="ignore", invalid="ignore"):
        cuts = np.where(first != last, (np.maximum(first, last) - start) / step, 1.0)
    before, after = np.minimum(*cuts.T)[:, None], np.maximum(*cuts.T)[:, None]
    points = np.stack([start, start + before * step, start + after * step, start + step], axis=1)
    return points[:, :-1].reshape(-1, 2), points[:, 1:].reshape(-1, 2)
