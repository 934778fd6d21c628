"""Corners of a marker from its edges: each edge is fitted as a blurred straight step, and neighbours are intersected.

Marker detectors find corners up to 0.9 px too far inside, because blur rounds them. Hundreds of pixels along an edge
locate it, away from the rounded corners. An edge is straight in the picture once the lens distortion is removed.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import least_squares
from scipy.special import ndtr

from sim2real.vision.camera import CameraModel

INSIDE, OUTSIDE = (
    0.6,
    0.5,
)  # cells from the edge in which pixels are used; farther ones belong to bits or to the margin's end
ALONG = 0.85  # share of each half edge that is used, since blur rounds the ends
BLUR = 1.0  # px, initial guess
CONTRAST = 8.0  # grey levels, least step of an edge; the table's far end is dim
MOST = 3.0  # px, greatest distance of an edge from where it was detected
ROUNDS = 2  # of choosing pixels and fitting
PIXELS = 12  # least number on an edge
GREY = 8.0  # grey levels, scale of the robust loss: larger residuals, of glints and dirt, count less


def refine(
    image: np.ndarray, camera: CameraModel, corners: np.ndarray, cells: int, contrast: float = CONTRAST
) -> np.ndarray | None:
    """Refine the detected corners (4, 2) [pixels] of a marker in a smoothed image (rows, columns).

    cells: along a side of the marker, its black border included; contrast: least step of an edge [grey levels]. Returns
    corners (4, 2) [pixels], or None if an edge is not clear.
    """
    for _ in range(ROUNDS):
        undistorted = camera.undistort(corners)
        lines = [_line(image, camera, undistorted, k, cells, contrast) for k in range(4)]
        found = [line for line in lines if line is not None]
        if len(found) < 4:
            return None
        corners = camera.distort(np.array([_intersection(found[k - 1], found[k]) for k in range(4)]))
    return corners


def _line(
    image: np.ndarray, camera: CameraModel, corners: np.ndarray, k: int, cells: int, contrast: float
) -> tuple[np.ndarray, np.ndarray] | None:
    """A point and a direction, in undistorted pixels, of the edge from corner k to the next; None if it is not
    clear."""
    one, other = corners[k], corners[(k + 1) % 4]
    half = 0.5 * float(np.linalg.norm(other - one))
    middle, along = 0.5 * (one + other), 0.5 * (other - one) / half
    outward = np.array([along[1], -along[0]])
    outward = outward * np.sign((middle - corners.mean(axis=0)) @ outward)
    cell = 2.0 * float((middle - corners.mean(axis=0)) @ outward) / cells
    columns, rows = _box(image, camera.distort(np.stack([one, other])), cell)
    places = camera.undistort(np.stack([columns, rows], axis=1).astype(float)) - middle
    position, depth = places @ along / half, places @ outward
    near = (np.abs(position) < ALONG) & (depth > -INSIDE * cell) & (depth < OUTSIDE * cell)
    if near.sum() < PIXELS:
        return None
    step = _step(position[near], depth[near], image[rows[near], columns[near]], contrast)
    if step is None:
        return None
    shift, turn = step
    return middle + shift * outward, along * half + turn * outward


def _box(image: np.ndarray, ends: np.ndarray, cell: float) -> tuple[np.ndarray, np.ndarray]:
    """Columns and rows (n,) of the image round an edge with ends (2, 2); cell: of the marker [pixels]."""
    low = np.maximum(np.floor(ends.min(axis=0) - cell - 1.0), 0.0).astype(int)
    high = np.minimum(np.ceil(ends.max(axis=0) + cell + 1.0), np.array(image.shape[::-1]) - 1).astype(int)
    columns, rows = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1))
    return columns.ravel(), rows.ravel()


def _step(position: np.ndarray, depth: np.ndarray, grey: np.ndarray, contrast: float) -> tuple[float, float] | None:
    """Fit a step from dark to bright, blurred by a normal distribution, to grey levels (n,).

    position: of each pixel along the edge, -1 to 1; depth: across it [pixels]. Returns the edge's shift at the middle
    and its further shift at the end [pixels]; None if there is no clear step near depth 0.
    """

    def model(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        shift, turn, low, high, blur = x
        z = (depth - shift - turn * position) / blur
        share, density = ndtr(z), np.exp(-0.5 * z * z) / np.sqrt(2.0 * np.pi)
        steep = -(high - low) * density / blur
        return low + (high - low) * share, np.stack([steep, steep * position, 1.0 - share, share, steep * z], axis=1)

    begin = np.array([0.0, 0.0, *np.quantile(grey, [0.05, 0.95]), BLUR])
    bounds = ([-np.inf, -np.inf, -np.inf, -np.inf, 0.3], [np.inf, np.inf, np.inf, np.inf, 5.0])
    found = least_squares(
        lambda x: model(x)[0] - grey,
        begin,
        lambda x: model(x)[1],  # pyright: ignore[reportArgumentType]
        bounds=bounds,
        x_scale=[0.1, 0.1, 5.0, 5.0, 0.1],
        loss="soft_l1",
        f_scale=GREY,
    )
    shift, turn, low, high, _ = found.x
    clear = found.success and high - low > contrast and abs(shift) + abs(turn) < MOST
    return (float(shift), float(turn)) if clear else None


def _intersection(one: tuple[np.ndarray, np.ndarray], other: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """The intersection (2,) of two lines, each given by a point and a direction."""
    (p, d), (q, e) = one, other
    return p + np.linalg.solve(np.stack([d, -e], axis=1), q - p)[0] * d
