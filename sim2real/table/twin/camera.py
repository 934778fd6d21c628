"""The twin's camera: places of puck and mallets with the rate, the delay and the noise of measured vision."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sim2real.table.backend import Place, SeenFrame
from sim2real.table.twin.coming_frames import ComingFrames
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


class TwinCamera(ComingFrames):
    """Takes frames of a plant at its `errors.rate`, the first at half a period."""

    def __init__(self, errors: CameraErrors, seed: int) -> None:
        super().__init__()
        self.errors = errors
        self.unplugged = False
        self._random, self._ring_random = np.random.default_rng([seed, 1]), np.random.default_rng([seed, 1, 1])
        self._taken = 0

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
            self.add(plant.time + self.errors.delay, frame)

    def _measured(self, place: ArrayLike, random: np.random.Generator) -> Place | None:
        x, y = np.asarray(place) + self.errors.noise * random.standard_normal(2)
        return (float(x), float(y)) if np.isfinite(x) else None
