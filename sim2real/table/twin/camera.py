"""The twin's camera: places of puck and opponent with the rate, the delay and the noise of measured vision."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from sim2real.table.backend import Place, SeenFrame
from sim2real.table.twin.plant import Plant


@dataclass(frozen=True)
class CameraErrors:
    """Frames a second, delay from exposure until a place can be used [s], and its noise, each coordinate [m]."""

    rate: float = 120.0
    delay: float = 0.006
    noise: float = 0.0001


class TwinCamera:
    """Takes frames of a plant at its `errors.rate`, the first at half a period."""

    def __init__(self, errors: CameraErrors, seed: int) -> None:
        self.errors = errors
        self.unplugged, self.late = False, 0.0
        self._random = np.random.default_rng([seed, 1])
        self._taken = 0
        self._coming: deque[SeenFrame] = deque()

    @property
    def next_exposure(self) -> float:
        """When the next frame is exposed [s]."""
        return (self._taken + 0.5) / self.errors.rate

    def expose(self, plant: Plant) -> None:
        """Take a frame of the plant as it is now."""
        self._taken += 1
        if not self.unplugged:
            puck, opponent = plant.puck[:2], np.array(plant.mallet(1)[:2])
            self._coming.append(SeenFrame(plant.time, self._measured(puck), self._measured(opponent)))

    def _measured(self, place: np.ndarray) -> Place | None:
        x, y = place + self.errors.noise * self._random.standard_normal(2)
        return (float(x), float(y)) if np.isfinite(x) else None

    def take(self, now: float) -> list[SeenFrame]:
        """The frames that can be used at `now` [s] and were not taken before."""
        found = []
        while self._coming and self._coming[0].time + self.errors.delay + self.late <= now:
            found.append(self._coming.popleft())
        return found
