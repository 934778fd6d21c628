"""The twin's camera: places of puck and mallets with the rate, the delay and the noise of measured vision."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sim2real.table.backend import Place, SeenFrame
from sim2real.table.twin.plant import Plant


@dataclass(frozen=True)
class CameraErrors:
    """Frames a second, delay from exposure until a place can be used [s], and its noise, each coordinate [m].

    The camera's clock is `stamp_late` [s] ahead, and gains `drift` [1].
    """

    rate: float = 120.0
    delay: float = 0.006
    noise: float = 0.0001
    stamp_late: float = 0.0
    drift: float = 0.0

    def stamp(self, exposed: float) -> float:
        """The stamp [s] of a frame exposed at a time [s]."""
        return (1.0 + self.drift) * exposed + self.stamp_late


class TwinCamera:
    """Takes frames of a plant at its `errors.rate`, the first at half a period."""

    def __init__(self, errors: CameraErrors, seed: int) -> None:
        self.errors = errors
        self.unplugged, self.late = False, 0.0
        self._random, self._ring_random = np.random.default_rng([seed, 1]), np.random.default_rng([seed, 1, 1])
        self._taken = 0
        self._coming: deque[tuple[float, SeenFrame]] = deque()  # with the time at which it can be used [s]

    @property
    def next_exposure(self) -> float:
        """When the next frame is exposed [s]."""
        return (self._taken + 0.5) / self.errors.rate

    def expose(self, plant: Plant) -> None:
        """Take a frame of the plant as it is now."""
        self._taken += 1
        if not self.unplugged:
            puck, opponent = (self._measured(place, self._random) for place in (plant.puck[:2], plant.mallet(1)[:2]))
            robot = self._measured(plant.mallet(0)[:2], self._ring_random)
            frame = SeenFrame(self.errors.stamp(plant.time), puck, opponent, robot=robot)
            self._coming.append((plant.time + self.errors.delay, frame))

    def _measured(self, place: ArrayLike, random: np.random.Generator) -> Place | None:
        x, y = np.asarray(place) + self.errors.noise * random.standard_normal(2)
        return (float(x), float(y)) if np.isfinite(x) else None

    def take(self, now: float) -> list[SeenFrame]:
        """The frames that can be used at `now` [s] and were not taken before."""
        found = []
        while self._coming and self._coming[0][0] + self.late <= now:
            found.append(self._coming.popleft()[1])
        return found
