"""The covariance of the measured positions of glides: noise of each frame, which may be autocorrelated, and calibration
errors, which are common to all frames."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from sim2real.diagnose.sensor_noise.map_error import modes
from sim2real.diagnose.sensor_noise.model import SensorNoise
from sim2real.statistics.whitening import whitened


class PositionCovariance:
    """Whitens changes of the positions of g segments; segment i has the frames first[i] … first[i + 1] − 1."""

    def __init__(
        self, t: np.ndarray, std: np.ndarray, first: np.ndarray, noise: Sequence[SensorNoise], size: np.ndarray
    ) -> None:
        """Set the data.

        `t` (n,) [s]; `std` (n, 2) [m]: of the frames' noise; `noise` (g,): the camera of each segment; `size` (2,) [m]:
        of the table. Recordings that state the same size of their calibration error share that error; different sizes
        mean different calibrations.
        """
        self._std, self._first, self._size = std, first, size
        stated = np.array([one.map_error_std for one in noise])
        self._map_error_std = np.repeat(stated, np.diff(first))
        self._calibrations = sorted({one for one in stated.tolist() if one})
        self._whiten = {
            i: np.linalg.inv(np.linalg.cholesky(one.correlation(t[a:b])))
            for i, ((a, b), one) in enumerate(zip(pairwise(first), noise, strict=True))
            if one.autocorrelation.share
        }

    def white(self, values: np.ndarray) -> np.ndarray:
        """Return changes of the positions (n, 2, …) [m], whitened to units of the noise, in the same shape."""
        whitened = values / self._std.reshape(*self._std.shape, *[1] * (values.ndim - 2))
        for i, whiten in self._whiten.items():
            rows = slice(self._first[i], self._first[i + 1])
            whitened[rows] = (whiten @ whitened[rows].reshape(len(whiten), -1)).reshape(whitened[rows].shape)
        return whitened

    def modes(self, place: np.ndarray) -> np.ndarray:
        """Return displacements (n, 2, m) [m] of positions (n, 2) [m] by each mode of the calibration errors.

        Modes are independent, of one standard deviation each; m is 0 if no recording states an error.
        """
        each = [modes(place, self._size, np.where(self._map_error_std == std, std, 0.0)) for std in self._calibrations]
        return np.concatenate([np.zeros((len(place), 2, 0)), *each], axis=2)

    def allowing(self, shared: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Return whitened rows (2n, k), whitened again for the common errors `shared` (2n, m).

        `shared`: the modes, whitened and projected like the rows.
        """
        return whitened(shared, rows) if shared.shape[1] else rows
