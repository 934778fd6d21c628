"""The exact share of each pixel that an outline covers: anti-aliasing by area instead of by samples."""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.kernel import kernel
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
    own, right = np.zeros((2, rows, columns + 2))
    add_edges(np.asarray(outline, float), box.top, box.left, own, right)
    shares = np.empty((rows, columns))
    add_up(own, right, shares)
    return shares


@kernel
def add_edges(outline, top, left, own, right):
    """Add the edges of a polygon (n, 2) to `own` and `right` (rows, columns + 2) of the box whose first pixel is at row
    `top` and column `left`: what they cover of their own pixels, and of those beside them on the right."""
    count = outline.shape[0]
    for i in range(count):
        j = i + 1 if i + 1 < count else 0
        u, v = outline[i, 0] - (left - 0.5), outline[i, 1] - (top - 0.5)
        along, down = outline[j, 0] - (left - 0.5) - u, outline[j, 1] - (top - 0.5) - v
        pieces = max(math.ceil(math.sqrt(along * along + down * down)), 1.0)
        _add_edge(u, v, along / pieces, down / pieces, int(pieces), own, right)


@kernel
def _add_edge(u, v, along, down, pieces, own, right):
    """Add an edge from (u, v), in pieces (along, down) that cross one border of pixels each way at most."""
    for k in range(pieces):
        u0, v0 = u + k * along, v + k * down
        first, second = _border(u0, along), _border(v0, down)
        if first > second:
            first, second = second, first
        u1, v1 = u0 + first * along, v0 + first * down
        u2, v2 = u0 + second * along, v0 + second * down
        _add_piece(u0, v0, u1, v1, own, right)
        _add_piece(u1, v1, u2, v2, own, right)
        _add_piece(u2, v2, u0 + along, v0 + down, own, right)


@kernel
def _border(start, step):
    """The share of a step at which it crosses a whole number; 1 if it does not."""
    first, last = math.floor(start), math.floor(start + step)
    return (max(first, last) - start) / step if first != last else 1.0


@kernel
def _add_piece(u0, v0, u1, v1, own, right):
    """Add a piece of an edge within one pixel."""
    rows, columns = own.shape[0], own.shape[1] - 2
    height, row = v1 - v0, math.floor(0.5 * (v0 + v1))
    if height != 0.0 and 0 <= row < rows:
        u = min(max(0.5 * (u0 + u1), 0.0), float(columns))
        column = math.floor(u)
        further = height * (u - column)
        own[int(row), int(column)] += height - further
        right[int(row), int(column) + 1] += further


@kernel
def add_up(own, right, shares):
    """Write the shares (rows, columns) from `own` and `right` of `add_edges`."""
    for row in range(shares.shape[0]):
        total = 0.0
        for column in range(shares.shape[1]):
            total += own[row, column] + right[row, column]
            shares[row, column] = min(abs(total), 1.0)


def cut(corners: np.ndarray, longest: float) -> tuple[np.ndarray, np.ndarray]:
    """Divide the edges of the polygon `corners` (n, k) into equal pieces no longer than `longest`: the start (m, k) of
    each piece, and the step (m, k) to its end."""
    pieces = np.empty(len(corners), np.intp)
    start, step = np.empty((2, _count_pieces(corners, longest, pieces), corners.shape[1]))
    _cut(corners, pieces, start, step)
    return start, step


@kernel
def _count_pieces(corners, longest, pieces):
    """Write into how many `pieces` (n,) each edge of `corners` (n, k) is divided, and return their sum."""
    count, total = corners.shape[0], 0
    for i in range(count):
        square = 0.0
        for axis in range(corners.shape[1]):
            square += (corners[(i + 1) % count, axis] - corners[i, axis]) ** 2
        pieces[i] = max(math.ceil(math.sqrt(square) / longest), 1)
        total += pieces[i]
    return total


@kernel
def _cut(corners, pieces, start, step):
    """Write start and step (m, k) of every piece."""
    count, place = corners.shape[0], 0
    for i in range(count):
        for number in range(pieces[i]):
            for axis in range(corners.shape[1]):
                move = (corners[(i + 1) % count, axis] - corners[i, axis]) / pieces[i]
                start[place, axis] = corners[i, axis] + number * move
                step[place, axis] = move
            place += 1
