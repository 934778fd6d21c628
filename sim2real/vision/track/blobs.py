"""Blobs: connected pixels that are as bright as retro-reflective film, and their outlines.

The lamp stands beside the camera, so the brightness of film falls with the square of the distance, and so does the
threshold. Pixels off the table never count as bright.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from sim2real.vision.locate import Locator

LEVEL = 75.0  # grey level, threshold between film and everything else in the middle of the table
COARSE = 16  # px between the nodes at which the distance is computed
NEVER = 255  # threshold that no pixel exceeds
FEWEST = 8  # pixels of an outline; smaller blobs are noise


@dataclass(frozen=True)
class Blob:
    """Connected bright pixels.

    outline: (n, 2), column and row of the bright pixels beside dark ones; hole: (m, 2), the same round the largest
    hole, None if there is none.
    """

    outline: np.ndarray
    hole: np.ndarray | None

    @property
    def box(self) -> tuple[int, int, int, int]:
        """The bounding box: left, top, and the column and row after the last."""
        left, top = self.outline.min(axis=0)
        right, bottom = self.outline.max(axis=0) + 1
        return int(left), int(top), int(right), int(bottom)


class BlobDetector:
    """Finds blobs on the table in pictures of one camera.

    size: columns and rows of the pictures; length, width: of the table [m]; height: up to which objects stand above it
    [m]; level: threshold in the middle of the table [grey levels]. Raises ValueError if no picture shows the table.
    """

    def __init__(
        self, locator: Locator, size: tuple[int, int], length: float, width: float, height: float, level: float = LEVEL
    ) -> None:
        inside = np.zeros(size[::-1], np.uint8)
        corners = np.array([(0.0, 0.0), (length, 0.0), (length, width), (0.0, width)])
        around = np.concatenate([locator.pixels(corners, z) for z in (0.0, height)])
        cv2.fillConvexPoly(inside, cv2.convexHull(around.round().astype(np.int32)), 1)
        columns, rows = np.flatnonzero(inside.any(axis=0)), np.flatnonzero(inside.any(axis=1))
        if not len(columns):
            raise ValueError(f"no part of the table is in a picture of {size[0]} x {size[1]} pixels")
        self.left, self.right, self.top, self.bottom = columns[0], columns[-1] + 1, rows[0], rows[-1] + 1
        part = slice(self.top, self.bottom), slice(self.left, self.right)
        lamp = level * _falloff(locator, size, np.array([0.5 * length, 0.5 * width]))
        self._limit = np.where(inside > 0, np.clip(lamp, 1.0, NEVER - 1.0), NEVER).astype(np.uint8)[part]

    @property
    def box(self) -> tuple[int, int, int, int]:
        """The part of a picture that shows the table: left, top, and the column and row after the last."""
        return int(self.left), int(self.top), int(self.right), int(self.bottom)

    def blobs(self, image: np.ndarray, region: tuple[int, int, int, int] | None = None) -> list[Blob]:
        """Find blobs in a picture uint8 (rows, columns), or only in a search region: left, top, and the column and row
        after the last."""
        left, top, right, bottom = region or (0, 0, image.shape[1], image.shape[0])
        left, top = max(left, self.left), max(top, self.top)
        right, bottom = min(right, self.right), min(bottom, self.bottom)
        if left >= right or top >= bottom:
            return []
        limit = self._limit[top - self.top : bottom - self.top, left - self.left : right - self.left]
        mask = cv2.compare(image[top:bottom, left:right], limit, cv2.CMP_GT)
        found, tree = cv2.findContours(mask, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE, offset=(int(left), int(top)))
        return [] if tree is None else _blobs(found, tree[0])


def _blobs(found: Sequence[np.ndarray], tree: np.ndarray) -> list[Blob]:
    """Pair outlines with their largest holes. OpenCV's tree has for each contour: the next and the previous one beside
    it, its first hole, and the contour whose hole it is."""
    holes: dict[int, np.ndarray] = {}
    for contour, (_, _, _, around) in zip(found, tree, strict=True):
        if around >= 0 and len(contour) >= FEWEST and len(contour) > len(holes.get(around, ())):
            holes[int(around)] = contour[:, 0]
    return [
        Blob(contour[:, 0], holes.get(number))
        for number, (contour, (*_, around)) in enumerate(zip(found, tree, strict=True))
        if around < 0 and len(contour) >= FEWEST
    ]


def _falloff(locator: Locator, size: tuple[int, int], middle: np.ndarray) -> np.ndarray:
    """The relative brightness float32 (rows, columns) of film on the table at each pixel; 1 in the middle of the
    table."""
    wide, high = (-(-one // COARSE) + 1 for one in size)
    u, v = np.meshgrid(COARSE * np.arange(wide, dtype=float), COARSE * np.arange(high, dtype=float))
    there = locator.distances(np.stack([u.ravel(), v.ravel()], axis=1)).reshape(high, wide)
    here = locator.distances(locator.pixels(middle[None], 0.0))[0]
    share = np.nan_to_num((here / there) ** 2).astype(np.float32)
    v, u = np.mgrid[0 : size[1], 0 : size[0]].astype(np.float32) / COARSE
    return cv2.remap(share, u, v, cv2.INTER_LINEAR)
