"""What places of glides err by: noise of each frame, which may hang together, and the calibration's, common to all."""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve_triangular

from sim2real.diagnose.engine.noise import allowing_for
from sim2real.diagnose.glide.data import GlideData
from sim2real.diagnose.glide.place_error import modes


class Errors:
    """Of the glides of a table of `size` (2,) [m]. What the calibration errs by is one thing for the clusters `apart`
    and another for the rest, so that neither tells the other's residuals anything."""

    def __init__(self, data: GlideData, size: np.ndarray, apart: np.ndarray) -> None:
        self._data, self._size = data, size
        self._place_std = data.of_frame(np.array(data.place_std)[data.recording]) if data.glides else np.zeros(0)
        here = data.of_frame(np.isin(data.cluster, apart))
        self._groups = [group for group in (here, ~here) if group.any()]
        self._roots = {
            g: np.linalg.cholesky(memory.covariance(data.t[data.first[g] : data.first[g + 1]]))
            for g in range(data.glides)
            if (memory := data.memories[data.recording[g]]).share > 0.0
        }

    @property
    def smooth(self) -> bool:
        """Whether the calibration says that it errs."""
        return bool(self._place_std.any())

    def white(self, values: np.ndarray) -> np.ndarray:
        """Changes of the places (n, 2, …) [m], as rows in units of white noise, in the same shape."""
        data = self._data
        whitened = values / data.std.reshape(*data.std.shape, *[1] * (values.ndim - 2))
        for g, root in self._roots.items():
            rows = slice(data.first[g], data.first[g + 1])
            flat = whitened[rows].reshape(len(root), -1)
            whitened[rows] = solve_triangular(root, flat, lower=True, check_finite=False).reshape(whitened[rows].shape)
        return whitened

    def modes(self, place: np.ndarray) -> np.ndarray:
        """Changes (n, 2, m) [m] of places (n, 2) by each independent deviation of the calibration; m is 0 where it
        states none."""
        if not self.smooth:
            return np.zeros((len(place), 2, 0))
        return modes(place, self._size, self._place_std)

    def allowing(self, shared: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Rows (2n, k), white again with what is `shared` (2n, m): the modes, treated as the rows are."""
        if not shared.shape[1]:
            return rows
        found = np.empty_like(rows)
        for group in self._groups:
            both = np.repeat(group, 2)
            found[both] = allowing_for(shared[both], rows[both])
        return found
