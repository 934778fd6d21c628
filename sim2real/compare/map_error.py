"""The error of places due to the camera's calibration, in a comparison."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.sensor_noise.map_error import modes

STEP = 1e-3  # s, difference step for the rate of the error along a motion


@dataclass(frozen=True)
class MapError:
    """The error of places on a table of `size` (2,) [m]: a smooth random field with deviation `std` [m], 0 if unstated.

    Deviations are the effects of each of the field's m independent standard normal coefficients.
    """

    size: np.ndarray
    std: float

    def of_places(self, place: np.ndarray) -> np.ndarray:
        """Deviations (n, 2, m) [m] of places (n, 2) [m]."""
        return modes(place, self.size, np.full(len(place), self.std))

    def of_motion(self, place: np.ndarray, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Deviations of a place (2,) [m] and of a velocity (2,) [m/s] there, (2, m) each."""
        here, later = self.of_places(np.stack([place, place + STEP * velocity]))
        return here, (later - here) / STEP
