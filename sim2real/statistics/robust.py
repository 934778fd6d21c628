"""Two robust losses, each as a weight of iteratively reweighted least squares, and a robust scale.

Errors are in units of the noise's standard deviation. Both losses grow with the logarithm of the error in the tail, so
that one gross error moves no fit far.

- `t_weights`, for single residuals any of which may be an outlier: Student's t. The weight falls with every error.
- `group_loss`, for the sum of squares of a group of residuals, such as a glide or a launch, that is an outlier as a
  group: the sum itself within the range of noise, logarithmic beyond. Groups within the noise have weight exactly 1,
  so that without outliers the fit is ordinary least squares and its covariance is valid; Student's t would weight such
  groups unequally.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.statistics.tuned import tuned

GAUSS = 0.6745  # the median absolute value of a standard normal number


@dataclass(frozen=True)
class RobustNumbers:
    """Thresholds and degrees of freedom of the robust losses."""

    t_freedom: float = tuned(
        4.0, "1", "outliers that pull the fit, or noise taken for outliers", "choice: usual degrees of freedom of a t"
    )
    group_sigmas: float = tuned(
        6.0,
        "standard deviations",
        "groups within the noise get less weight, or outliers full weight",
        "choice: noise alone hardly ever reaches it",
    )
    group_margin: float = tuned(
        4.0,
        "1",
        "the skew of chi-square where degrees of freedom are few",
        "choice: noise alone hardly ever reaches it",
    )
    smallest_square: float = tuned(1e-9, "1", "a division by zero", "choice: far below any noise")


ROBUST = RobustNumbers()


def t_weights(z: np.ndarray) -> np.ndarray:
    """Weights (n,) of residuals `z` (n,) with the loss (nu + 1) log(1 + z² / nu), that of Student's t with
    nu = `ROBUST.t_freedom` degrees of freedom: (nu + 1) / (nu + z²)."""
    return (ROBUST.t_freedom + 1) / (ROBUST.t_freedom + z**2)


def group_threshold(freedom: np.ndarray) -> np.ndarray:
    """Sums of squares (c,) that noise alone rarely exceeds in groups with `freedom` (c,) degrees of freedom: the mean
    of chi-square, plus some standard deviations sqrt(2 freedom), plus a margin."""
    return freedom + ROBUST.group_sigmas * np.sqrt(2.0 * freedom) + ROBUST.group_margin


def group_loss(squares: np.ndarray, freedom: np.ndarray) -> np.ndarray:
    """Losses (c,) of groups with sums of squares s (c,) and `freedom` (c,) degrees of freedom: s up to the threshold t
    of `group_threshold`, t (1 + log(s / t)) beyond. Loss and slope are continuous."""
    threshold = group_threshold(freedom)
    tail = threshold * (1.0 + np.log(np.maximum(squares, threshold) / threshold))
    return np.where(squares > threshold, tail, squares)


def group_weights(squares: np.ndarray, freedom: np.ndarray) -> np.ndarray:
    """Weights (c,) of groups for `group_loss`, its derivative by s: min(1, t / s)."""
    return np.minimum(group_threshold(freedom) / np.maximum(squares, ROBUST.smallest_square), 1.0)


def typical(z: np.ndarray) -> float:
    """Robust standard deviation, at least 1, of errors `z` (n,) in units of their noise, by the median of |z|."""
    return max(1.0, float(np.median(np.abs(z))) / GAUSS)
