"""What laws do not predict, averaged in bins along a coordinate and in cells of the table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.result.result import Mismatch
from sim2real.statistics.binned import Binned, binned

STANDARD_ERRORS = 2.0  # that an error bar shows, and from which an arrow is coloured
CELLS = 10  # of the map, along the table
ARROWS_IN_FULL = 0.9  # share of the arrows that are drawn in full, the longest of them a cell long
LONGEST_ARROW = 2.0  # cells, at which longer ones are cut
FEWEST_IN_CELL = 3  # pieces
SAME = 0.02  # of the noise, by which before and after may differ and be one
BEFORE, AFTER, REFITTED = "before", "after", "refitted"


@dataclass(frozen=True)
class MapArrows:
    """Arrows on the table: `places` and `vectors` (k, 2) [m], of which a cell's length stands for `scale` in the
    mismatch's unit; `sure` (k,): whether each is more than noise."""

    places: np.ndarray
    vectors: np.ndarray
    sure: np.ndarray
    scale: float


def along(mismatch: Mismatch, coordinate: str, component: int) -> dict[str, Binned]:
    """A component in bins along a coordinate: before and after, or one series where nothing was found."""
    x, std = mismatch.by[coordinate], mismatch.std[:, component]
    return {name: binned(x, values[:, component], std) for name, values in _series(mismatch).items()}


def unchanged(mismatch: Mismatch) -> bool:
    """Whether nothing was found, so that before and after are one."""
    return bool(np.all(np.abs(mismatch.after - mismatch.before) < SAME * mismatch.std))


def map_arrows(mismatch: Mismatch) -> dict[str, MapArrows]:
    """Mean residual vectors by cell of the table, before and after, to one scale; none leaves the table."""
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
            sure,
            scale,
        )
        for name, (places, means, sure) in found.items()
    }


def cell_means(mismatch: Mismatch, values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Weighted means of the vectors `values` (n, c) by cell: places (k, 2) [m], vectors (k, 2), sure or not (k,)."""
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
    places, means, sure = (np.array(column) for column in zip(*found, strict=True))
    return places, means, sure


def _series(mismatch: Mismatch) -> dict[str, np.ndarray]:
    if unchanged(mismatch):
        return {REFITTED: mismatch.after}
    return {BEFORE: mismatch.before, AFTER: mismatch.after}


def _within(place: np.ndarray, arrow: np.ndarray, size: tuple[float, float]) -> np.ndarray:
    """An arrow, cut where it would leave the table or be longer than LONGEST_ARROW cells."""
    room = np.where(arrow > 0.0, np.array(size) - place, place)
    share = room / np.maximum(np.abs(arrow), 1e-12)
    longest = LONGEST_ARROW * size[0] / CELLS / max(float(np.hypot(*arrow)), 1e-12)
    return arrow * float(np.clip(min(longest, *share), 0.0, 1.0))
