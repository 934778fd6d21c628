"""Autocorrelated errors of the puck's measured positions, as caused by an outline that moves over pixels.

A `share` of the variance of each coordinate has the correlation exp(-|dt| / time) between frames; the rest is white.
Share and time are estimated by restricted maximum likelihood (Patterson and Thompson, 1971) from the residuals of
polynomials fitted to the glides, with the polynomials' coefficients integrated out.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import solve_triangular

from sim2real.diagnose.sensor_noise.tuned import SENSOR_NOISE


@dataclass(frozen=True)
class AutocorrelatedNoise:
    """Autocorrelated noise.

    `share` [1]: of the variance, whose correlation decays with the time constant `time` [s]; `scale` [1]: the total
    standard deviation in units of the assumed one.
    """

    share: float = 0.0
    time: float = 1.0
    scale: float = 1.0

    def covariance(self, t: np.ndarray) -> np.ndarray:
        """Return the covariance (n, n) of errors of unit variance at the times `t` (n,) [s]."""
        correlation = self.share * np.exp(-np.abs(t[:, None] - t) / self.time)
        np.fill_diagonal(correlation, 1.0)
        return correlation


@dataclass(frozen=True)
class Excerpt:
    """A glide or a part of one: times `t` (n,) [s], `place` (n, 2) [m], and the assumed standard deviation `std` (n, 2)
    [m] of each coordinate."""

    t: np.ndarray
    place: np.ndarray
    std: np.ndarray

    def cut(self, frames: int) -> Iterator[Excerpt]:
        """Yield consecutive parts of about `frames` frames each."""
        for rows in np.array_split(np.arange(len(self.t)), max(len(self.t) // frames, 1)):
            yield Excerpt(self.t[rows], self.place[rows], self.std[rows])


def estimate_autocorrelation(glides: Sequence[Excerpt], order: int, period: float) -> AutocorrelatedNoise:
    """Estimate the autocorrelation of the errors of glides about polynomials of order `order`.

    `period` [s]: time between frames, the unit of the correlation times that are tried. Returns white noise with scale
    1 if no autocorrelation raises the log-likelihood by `SENSOR_NOISE.likelihood_gain`.
    """
    parts = [part for glide in glides for part in glide.cut(SENSOR_NOISE.correlated_frames)]
    if not parts:
        return AutocorrelatedNoise()
    best = AutocorrelatedNoise()
    white, _ = _likelihood(parts, best, order)
    most = white + SENSOR_NOISE.likelihood_gain
    for frames in SENSOR_NOISE.correlation_frames:
        before = white
        for share in SENSOR_NOISE.shares:
            tried = AutocorrelatedNoise(share, frames * period)
            likelihood, scale = _likelihood(parts, tried, order)
            if likelihood > most:
                most, best = likelihood, replace(tried, scale=scale)
            if likelihood < before:  # it has one maximum over the share
                break
            before = likelihood
    return best


def polynomial_residual(part: Excerpt, order: int, root: np.ndarray | None = None) -> tuple[float, int, float]:
    """Fit polynomials of order `order` to both coordinates of a part.

    `root` (n, n): Cholesky factor of the noise correlation, by which the noise is whitened; None for white noise.

    Returns the residuals' sum of squares in units of the assumed noise, their degrees of freedom, and half the
    logarithm of the determinant of the coefficients' information matrices.
    """
    basis, squares, freedom, information = _polynomials(part.t, order), 0.0, 0, 0.0
    for place, std in zip(part.place.T, part.std.T, strict=True):
        whitened = np.concatenate([basis, place[:, None]], axis=1) / std[:, None]
        whitened = whitened if root is None else solve_triangular(root, whitened, lower=True, check_finite=False)
        q, r = np.linalg.qr(whitened[:, :-1])
        rest = whitened[:, -1] - q @ (q.T @ whitened[:, -1])
        squares, freedom = squares + float(rest @ rest), freedom + len(rest) - len(r)
        information += float(np.log(np.abs(np.diag(r))).sum())
    return squares, freedom, information


def _polynomials(t: np.ndarray, order: int) -> np.ndarray:
    """Return powers (n, k) of the times `t` (n,), scaled to a range of 1, up to `order`, or lower for few frames."""
    return np.vander((t - t[0]) / np.ptp(t) - 0.5, min(order, len(t) // 4) + 1)


def _likelihood(parts: Sequence[Excerpt], noise: AutocorrelatedNoise, order: int) -> tuple[float, float]:
    """Return the restricted log-likelihood, up to a constant, and the scale of all parts, at least 1.

    Each part has its own maximum-likelihood scale, so that no outlying part dominates; the common scale clips outliers.
    """
    total, variances, counts = 0.0, [], []
    for part in parts:
        root = np.linalg.cholesky(noise.covariance(part.t))
        squares, freedom, information = polynomial_residual(part, order, root)
        variances.append(squares / freedom)
        counts.append(freedom)
        determinant = 2.0 * float(np.log(np.diag(root)).sum())
        total -= 0.5 * freedom * float(np.log(variances[-1])) + determinant + information
    usual = np.minimum(variances, SENSOR_NOISE.outlier_ratio * np.median(variances))
    return total, max(float(np.sqrt(np.average(usual, weights=counts))), 1.0)
