"""Scattered data as a few means with errors, for the eye."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.interval import reach_of_launches

FEWEST = 4  # pieces of a bin
DRAWN = 80  # places at which a smooth law is drawn
ROUGH, SEEN = 0.15, 0.1  # share of a law's own spread, and of the data's errors, by which neighbours of one law differ


@dataclass(frozen=True)
class Binned:
    """Bins (b,): mean coordinate `x`, weighted mean `y` and its standard error; `members` (b, n) bool."""

    x: np.ndarray
    y: np.ndarray
    error: np.ndarray
    members: np.ndarray


def binned(x: np.ndarray, y: np.ndarray, std: np.ndarray, bins: int = 12) -> Binned:
    """`y` (n,) of noise `std` (n,) in up to `bins` bins of equally many pieces along `x` (n,).

    The error is the larger of what the noise and what the scatter within the bin give. Pieces without `x` (nan) are
    left out, and bins of fewer than FEWEST pieces are joined; equal `x` are never parted.
    """
    known = np.isfinite(x) & np.isfinite(y)
    count = int(min(bins, known.sum() // FEWEST))
    if count < 1:
        return Binned(np.zeros(0), np.zeros(0), np.zeros(0), np.zeros((0, len(x)), bool))
    edges = np.unique(np.quantile(x[known], np.linspace(0.0, 1.0, count + 1)))
    which = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, max(len(edges) - 2, 0))
    members = np.array([known & (which == k) for k in range(max(len(edges) - 1, 1))])
    members = members[members.sum(axis=1) >= min(FEWEST, int(known.sum()))]
    return over(members, x, y, std)


def over(members: np.ndarray, x: np.ndarray, y: np.ndarray, std: np.ndarray) -> Binned:
    """The means over given `members` (b, n) bool; see `binned`."""
    rows = [_mean(x[here], y[here], std[here]) for here in members]
    place, mean, error = (np.array(column) for column in zip(*rows, strict=True)) if rows else [np.zeros(0)] * 3
    return Binned(place, mean, error, members)


def is_rough(x: np.ndarray, y: np.ndarray, std: np.ndarray) -> bool:
    """Whether a law `y` (n,), of which the data have errors `std` (n,), is no curve over `x` (n,): it depends on more,
    and neighbours along `x` differ."""
    in_order = y[np.argsort(x, kind="stable")]
    if len(in_order) < 2:
        return False
    differ = float(np.sqrt(np.mean(np.diff(in_order) ** 2) / 2.0))
    return differ > ROUGH * float(in_order.std()) and differ > SEEN * float(np.median(std))


def singles(x: np.ndarray) -> np.ndarray:
    """Bins (b, n) bool of one piece each, of up to DRAWN pieces from the least `x` (n,) to the greatest, evenly."""
    order = np.argsort(x, kind="stable")
    order = order[np.isfinite(x[order])]
    if not len(order):
        return np.zeros((0, len(x)), bool)
    even = np.linspace(x[order[0]], x[order[-1]], DRAWN)
    at = order[np.unique(np.clip(np.searchsorted(x[order], even), 0, len(order) - 1))]
    return np.arange(len(x)) == at[:, None]


def half_band(bins: Binned, std: np.ndarray, columns: np.ndarray, spread: np.ndarray, launches: int) -> np.ndarray:
    """Half widths (b,) of the 95 % band of binned `columns` (n, k) whose coefficients have the covariance `spread`, as
    told by so many launches."""
    weight = bins.members / std**2
    mean = (weight / weight.sum(axis=1, keepdims=True)) @ columns
    return reach_of_launches(launches) * np.sqrt(np.maximum(np.einsum("bi,ij,bj->b", mean, spread, mean), 0.0))


def _mean(x: np.ndarray, y: np.ndarray, std: np.ndarray) -> tuple[float, float, float]:
    weight = 1.0 / std**2
    total = weight.sum()
    mean = float(weight @ y / total)
    scatter = float(np.sqrt(weight**2 @ (y - mean) ** 2)) / total
    return float(weight @ x / total), mean, max(float(total**-0.5), scatter)
