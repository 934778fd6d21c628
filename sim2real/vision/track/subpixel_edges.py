"""Edge points of a blob, with sub-pixel accuracy, on the table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from puckpilot_env.kernel import kernel

REACH = 3.0  # px to either side of the outline in which the edge is searched
FINE = 0.5  # px between samples of the grey level
CONTRAST = 8.0  # grey levels, least step of an edge

Places = Callable[[np.ndarray], np.ndarray]  # from pixels (n, 2) to places on the table (n, 2) [m]


@dataclass(frozen=True)
class EdgePoints:
    """Points of an edge on the table.

    places: (n, 2) [m]; steps: (n, 2) [m], the displacement on the table for one pixel outwards.
    """

    places: np.ndarray
    steps: np.ndarray

    def __len__(self) -> int:
        return len(self.places)

    @classmethod
    def joined(cls, edges: list[EdgePoints]) -> EdgePoints:
        """The points of several edges."""
        if len(edges) == 1:
            return edges[0]
        return cls(np.concatenate([edge.places for edge in edges]), np.concatenate([edge.steps for edge in edges]))

    def where(self, mask: np.ndarray) -> EdgePoints:
        """The points that a mask (n,) selects."""
        return EdgePoints(self.places[mask], self.steps[mask])


def find_edge_points(image: np.ndarray, outline: np.ndarray, places: Places) -> EdgePoints:
    """Find the edge along an outline (n, 2) of bright pixels in a picture uint8 (rows, columns). Points without a clear
    edge are left out."""
    edges = np.empty((len(outline), 4))
    count = _edges(image, np.ascontiguousarray(outline, np.int32), edges)
    pixels, outwards = edges[:count, :2], edges[:count, 2:]
    both = places(np.concatenate([pixels, pixels + outwards]))
    edge = EdgePoints(both[:count], both[count:] - both[:count])
    if np.isfinite(both.sum()):
        return edge
    finite = np.isfinite(edge.places) & np.isfinite(edge.steps)
    return edge.where(finite[:, 0] & finite[:, 1])


@kernel
def _edges(image, outline, edges):
    """Write column, row and the outward unit vector [pixels] of each clear edge point into `edges` (n, 4). Returns
    their number.

    An edge point is where the grey level along its gradient, interpolated between pixels, crosses the mean of the
    levels REACH to either side. Blur, of the lens or by motion, does not shift this point on a straight edge.
    """
    high, wide = image.shape
    count = 0
    border = REACH + 1.0
    for i in range(outline.shape[0]):
        u, v = float(outline[i, 0]), float(outline[i, 1])
        if not (border <= u < wide - 1 - border and border <= v < high - 1 - border):
            continue
        along_u, along_v = _slope(image, outline[i, 0], outline[i, 1])
        length = np.hypot(along_u, along_v)
        if length == 0.0:
            continue
        out_u, out_v = -along_u / length, -along_v / length
        inside = _level(image, u - REACH * out_u, v - REACH * out_v)
        outside = _level(image, u + REACH * out_u, v + REACH * out_v)
        if inside - outside < CONTRAST:
            continue
        t = _fall(image, u, v, out_u, out_v, 0.5 * (inside + outside))
        if t <= REACH:
            edges[count, 0], edges[count, 1] = u + t * out_u, v + t * out_v
            edges[count, 2], edges[count, 3] = out_u, out_v
            count += 1
    return count


@kernel
def _slope(image, u, v):
    """The gradient of the grey levels at a pixel, with Scharr's weights."""
    along_u, along_v = 0.0, 0.0
    for d in range(-1, 2):
        weight = 10.0 if d == 0 else 3.0
        along_u += weight * (float(image[v + d, u + 1]) - float(image[v + d, u - 1]))
        along_v += weight * (float(image[v + 1, u + d]) - float(image[v - 1, u + d]))
    return along_u, along_v


@kernel
def _level(image, u, v):
    """The grey level at column u and row v, interpolated bilinearly."""
    column, row = int(u), int(v)
    right, down = u - column, v - row
    top = image[row, column] * (1.0 - right) + image[row, column + 1] * right
    bottom = image[row + 1, column] * (1.0 - right) + image[row + 1, column + 1] * right
    return top * (1.0 - down) + bottom * down


@kernel
def _fall(image, u, v, out_u, out_v, middle):
    """How far outwards [px] of the outline the level falls through `middle`, at the crossing nearest to the outline;
    more than REACH if there is none."""
    best = 2.0 * REACH
    before = _level(image, u - REACH * out_u, v - REACH * out_v)
    steps = int(2.0 * REACH / FINE)
    for k in range(1, steps + 1):
        t = k * FINE - REACH
        now = _level(image, u + t * out_u, v + t * out_v)
        if before >= middle > now:
            there = t - FINE * (middle - now) / (before - now)
            if abs(there) < abs(best):
                best = there
        before = now
    return best
