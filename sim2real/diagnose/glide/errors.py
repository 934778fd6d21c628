"""What places of glides err by: noise of each frame, which may hang together, and the calibration's, common to all."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from sim2real.diagnose.engine.noise import allowing_for
from sim2real.diagnose.glide.data import GlideData
from sim2real.diagnose.glide.place_error import modes


class Errors:
    """Of the glides of a table of `size` (2,) [m]. What the calibration errs by is one thing for each size that
    recordings state, since no two calibrations come to the same one."""

    def __init__(self, data: GlideData, size: np.ndarray) -> None:
        self._data, self._size = data, size
        self._place_std = data.of_frame(np.array(data.place_std)[data.recording]) if data.glides else np.zeros(0)
        self._stated = sorted({std for std in data.place_std if std})
        self._whiten = {
            g: np.linalg.inv(np.linalg.cholesky(memory.covariance(data.t[a:b])))
            for g, (a, b) in enumerate(pairwise(data.first))
            if (memory := data.memories[data.recording[g]]).share
        }

    def white(self, values: np.ndarray) -> np.ndarray:
        """Changes of the places (n, 2, …) [m], as rows in units of white noise, in the same shape."""
        data = self._data
        whitened = values / data.std.reshape(*data.std.shape, *[1] * (values.ndim - 2))
        for g, whiten in self._whiten.items():
            rows = slice(data.first[g], data.first[g + 1])
            whitened[rows] = (whiten @ whitened[rows].reshape(len(whiten), -1)).reshape(whitened[rows].shape)
        return whitened

    def modes(self, place: np.ndarray) -> np.ndarray:
        """Changes (n, 2, m) [m] of places (n, 2) by each independent deviation of the calibrations; m is 0 where none
        is stated."""
        each = [modes(place, self._size, np.where(self._place_std == std, std, 0.0)) for std in self._stated]
        return np.concatenate([np.zeros((len(place), 2, 0)), *each], axis=2)

    def allowing(self, shared: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Rows (2n, k), white again with what is `shared` (2n, m): the modes, treated as the rows are."""
        return allowing_for(shared, rows) if shared.shape[1] else rows
