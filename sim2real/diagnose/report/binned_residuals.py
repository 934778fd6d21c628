"""Residuals averaged in bins along a coordinate and in cells of the table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.result.result import Mismatch
from sim2real.statistics.binned import Binned, binned

STANDARD_ERRORS = 2.0  # of an error bar, and beyond which an arrow is significant
CELLS = 10  # of the map, along the table
ARROWS_IN_FULL = 0.9  # share of the arrows that are not cut; the longest of them is one cell long
LONGEST_ARROW = 2.0  # cells; longer ones are cut
FEWEST_IN_CELL = 3  # segments
SAME = 0.02  # of the noise, up to which before and after count as equal
BEFORE, AFTER, REFITTED = "before", "after", "refitted"


@dataclass(frozen=True)
class MapArrows:
    """Arrows on the table at `places` (k, 2) [m] with `vectors` (k, 2) [m].

    `significant` (k,) bool: which exceed the noise; `scale`: the size in the mismatch's unit of an arrow of one cell.
    """

    places: np.ndarray
    vectors: np.ndarray
    significant: np.ndarray
    scale: float


def along(mismatch: Mismatch, coordinate: str, component: int) -> dict[str, Binned]:
    """Return the bins of a component along a coordinate: before and after, or one series if nothing was found."""
    x, std = mismatch.by[coordinate], mismatch.std[:, component]
    return {name: binned(x, values[:, component], std) for name, values in _series(mismatch).items()}


def unchanged(mismatch: Mismatch) -> bool:
    """Return whether nothing was found, so that before and after are equal."""
    return bool(np.all(np.abs(mismatch.after - mismatch.before) < SAME * mismatch.std))


def map_arrows(mismatch: Mismatch) -> dict[str, MapArrows]:
    """Return mean residual vectors by cell, before and after, with a common scale, clipped to the table."""
    assert mismatch.size is not None
    size = mismatch.size
    found = {name: cell_means(mismatch, values) for name, values in _series(mismatch).items()}
    lengths = np.concatenate([np.hypot(*means.T) for _, means, _ in found.values()])
    scale = (float(np.quantile(lengths, ARROWS_IN_FULL)) if len(lengths) else 0.0) or 1.0
    cell = size[0] / CELLS
    return {
        name: MapArrows(
            places,
            np.array([_within(*each, size) for each in zip(places, means / scale * cell, strict=True)]).reshape(-1, 2),
            significant,
            scale,
        )
        for name, (places, means, significant) in found.items()
    }


def cell_means(mismatch: Mismatch, values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return weighted means of the vectors `values` (n, c) by cell.

    These are places (k, 2) [m], vectors (k, 2), and whether each is significant (k,).
    """
    assert mismatch.place is not None and mismatch.axis is not None and mismatch.size is not None
    cell = mismatch.size[0] / CELLS
    left = np.stack([-mismatch.axis[:, 1], mismatch.axis[:, 0]], axis=1)
    vectors = values[:, :1] * mismatch.axis + values[:, 1:2] * left
    where = np.floor(mismatch.place / cell).astype(int)
    found = []
    for here in np.unique(where, axis=0):
        use = (where == here).all(axis=1)
        if use.sum() >= FEWEST_IN_CELL:
            weight = 1.0 / (mismatch.std[use, :2] ** 2).mean(axis=1)
            weight /= weight.sum()
            mean = weight @ vectors[use]
            error = np.sqrt(weight**2 @ ((vectors[use] - mean) ** 2).sum(axis=1))
            found.append((weight @ mismatch.place[use], mean, np.hypot(*mean) > STANDARD_ERRORS * error))
    if not found:
        return np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0, bool)
    places, means, significant = (np.array(column) for column in zip(*found, strict=True))
    return places, means, significant


def _series(mismatch: Mismatch) -> dict[str, np.ndarray]:
    if unchanged(mismatch):
        return {REFITTED: mismatch.after}
    return {BEFORE: mismatch.before, AFTER: mismatch.after}


def _within(place: np.ndarray, arrow: np.ndarray, size: tuple[float, float]) -> np.ndarray:
    """Return an arrow clipped to the table and to a length of LONGEST_ARROW cells."""
    room = np.where(arrow > 0.0, np.array(size) - place, place)
    share = room / np.maximum(np.abs(arrow), 1e-12)
    longest = LONGEST_ARROW * size[0] / CELLS / max(float(np.hypot(*arrow)), 1e-12)
    return arrow * float(np.clip(min(longest, *share), 0.0, 1.0))
