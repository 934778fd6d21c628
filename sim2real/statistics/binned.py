"""Summarise scattered data by a few bin means with errors, for figures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.statistics.intervals import reach_of_launches
from sim2real.statistics.tuned import tuned


@dataclass(frozen=True)
class FigureNumbers:
    """Tuned numbers of binned figures."""

    fewest: int = tuned(4, "points", "bins whose scatter is unknown", "choice: three degrees of freedom")
    drawn: int = tuned(80, "places", "curves with corners, or large pages", "choice: 80 look smooth")
    rough: float = tuned(
        0.15,
        "of the law's spread",
        "a law of two coordinates drawn as a curve of one",
        "choice, held by test_binned.py",
    )
    rough_noise: float = tuned(
        0.1, "of the data's errors", "rounding of a constant law taken for rough", "choice, held by test_binned.py"
    )


FIGURES = FigureNumbers()


@dataclass(frozen=True)
class Binned:
    """Bins: weighted means `x`, `y` (b,), the standard error (b,) of `y`, and `members` (b, n) bool of n points."""

    x: np.ndarray
    y: np.ndarray
    error: np.ndarray
    members: np.ndarray


def binned(x: np.ndarray, y: np.ndarray, std: np.ndarray, bins: int = 12) -> Binned:
    """Bin `y` (n,) with noise `std` (n,) into up to `bins` bins along `x` (n,), with equal numbers of points.

    The standard error is the larger of that by the noise and that by the scatter within the bin. Points without `x`
    (nan) are omitted, no bin has fewer than FIGURES.fewest points, and points with equal `x` share a bin.
    """
    known = np.isfinite(x) & np.isfinite(y)
    count = int(min(bins, known.sum() // FIGURES.fewest))
    if count < 1:
        return Binned(np.zeros(0), np.zeros(0), np.zeros(0), np.zeros((0, len(x)), bool))
    edges = np.unique(np.quantile(x[known], np.linspace(0.0, 1.0, count + 1)))
    which = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, max(len(edges) - 2, 0))
    members = np.array([known & (which == k) for k in range(max(len(edges) - 1, 1))])
    members = members[members.sum(axis=1) >= min(FIGURES.fewest, int(known.sum()))]
    return over(members, x, y, std)


def over(members: np.ndarray, x: np.ndarray, y: np.ndarray, std: np.ndarray) -> Binned:
    """The bins of `x`, `y` (n,) with noise `std` (n,) for given `members` (b, n) bool; see `binned`."""
    rows = [_mean(x[here], y[here], std[here]) for here in members]
    place, mean, error = (np.array(column) for column in zip(*rows, strict=True)) if rows else [np.zeros(0)] * 3
    return Binned(place, mean, error, members)


def is_rough(x: np.ndarray, y: np.ndarray, std: np.ndarray) -> bool:
    """Whether a law's values `y` (n,) at data with errors `std` (n,) are not a function of `x` (n,) alone.

    They are not if neighbours along `x` differ by a large share of the law's own spread.
    """
    in_order = y[np.argsort(x, kind="stable")]
    if len(in_order) < 2:
        return False
    differ = float(np.sqrt(np.mean(np.diff(in_order) ** 2) / 2.0))
    return differ > FIGURES.rough * float(in_order.std()) and differ > FIGURES.rough_noise * float(np.median(std))


def singles(x: np.ndarray) -> np.ndarray:
    """Bins (b, n) bool of one point each: up to FIGURES.drawn points, evenly spread over `x` (n,)."""
    order = np.argsort(x, kind="stable")
    order = order[np.isfinite(x[order])]
    if not len(order):
        return np.zeros((0, len(x)), bool)
    even = np.linspace(x[order[0]], x[order[-1]], FIGURES.drawn)
    at = order[np.unique(np.clip(np.searchsorted(x[order], even), 0, len(order) - 1))]
    return np.arange(len(x)) == at[:, None]


def half_band(bins: Binned, std: np.ndarray, columns: np.ndarray, spread: np.ndarray, launches: int) -> np.ndarray:
    """Half widths (b,) of the 95 % band of binned `columns` (n, k) whose coefficients have the covariance `spread`
    (k, k); Student's t with the degrees of freedom of `launches` launches."""
    weight = bins.members / std**2
    mean = (weight / weight.sum(axis=1, keepdims=True)) @ columns
    return reach_of_launches(launches) * np.sqrt(np.maximum(np.einsum("bi,ij,bj->b", mean, spread, mean), 0.0))


def _mean(x: np.ndarray, y: np.ndarray, std: np.ndarray) -> tuple[float, float, float]:
    """Weighted means of `x` and `y` (n,) with noise `std` (n,), and the standard error of the mean of `y`."""
    weight = 1.0 / std**2
    total = weight.sum()
    mean = float(weight @ y / total)
    scatter = float(np.sqrt(weight**2 @ (y - mean) ** 2)) / total
    return float(weight @ x / total), mean, max(float(total**-0.5), scatter)
