"""From a picture to where puck and opponent are: outlines, edges, ring and disc, and what was known before."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sim2real.vision.locate import Grid, Locator
from sim2real.vision.track.bright import LEVEL, Bright
from sim2real.vision.track.disc import Disc
from sim2real.vision.track.follow import Estimate, Follower, Sighting
from sim2real.vision.track.puck import PuckFinder
from sim2real.vision.track.ring import Ring, RingFinder
from sim2real.vision.track.window import Windows

SURE_WITHIN = 0.25e-3  # m, standard deviation at most of what can be nothing else than the puck
PUCK_POWER, OPPONENT_POWER = 0.02, 5.0  # m^2/s^3, of what changes their velocities between contacts
AROUND = 2.0  # radii round where something should be that are looked at
ROOM = 4.0  # standard deviations more
EVERY = 4  # pictures, of which one is looked at as a whole where an opponent might come


@dataclass(frozen=True)
class Seen:
    """What is known after a picture; None: not known where. `pucks`: things in it that may be the puck."""

    puck: Estimate | None
    opponent: Estimate | None
    pucks: int


class Eye:
    """Looks at pictures of `size` (columns, rows), each with the time of its mid-exposure [s]."""

    def __init__(
        self, locator: Locator, size: tuple[int, int], *, length: float, width: float, puck_radius: float,
        puck_height: float, ring_height: float, level: float = LEVEL, calibration_error: float = 0.0,
    ) -> None:  # fmt: skip
        """`calibration_error`: standard deviation along each axis [m] of what all pictures have a place wrong by."""
        self._reach = AROUND * puck_radius
        self._windows = [Windows(locator, height, length, width) for height in (puck_height, ring_height)]
        self._bright = Bright(locator, size, length, width, ring_height, level)
        self._pucks = PuckFinder(Grid(locator, puck_height, size).places, puck_radius)
        self._rings = RingFinder(Grid(locator, ring_height, size).places)
        self._puck, self._opponent = Follower(PUCK_POWER), Follower(OPPONENT_POWER)
        self._calibration = np.diag([calibration_error**2, calibration_error**2, 0.0, 0.0])
        self._partly = 0  # pictures since one was looked at as a whole

    def look(self, image: np.ndarray, time: float) -> Seen:
        """What this picture, uint8 (rows, columns), adds."""
        near = self._near(image, time)
        self._partly = 0 if near is None else self._partly + 1
        rings, discs = self._find(image, None) if near is None else near
        puck = self._puck.see(time, [_of_disc(disc) for disc in discs])
        opponent = self._opponent.see(time, [_of_ring(ring) for ring in rings])
        return Seen(self._told(puck), self._told(opponent), len(discs))

    def _near(self, image: np.ndarray, time: float) -> tuple[list[Ring], list[Disc]] | None:
        """What is seen where things should be; None if the whole picture is to be looked at: something is not there,
        the puck is not known, nor the opponent, for whom one look in EVERY suffices until one is seen."""
        place = self._window(0, time)
        if place is None:
            return None
        _, discs = self._find(image, place)  # where both are near, each window shows both
        if not any(_of_disc(disc).sure for disc in discs):
            return None
        place = self._window(1, time)
        if place is None:
            return None if self._opponent.in_sight or self._partly >= EVERY - 1 else ([], discs)
        rings, _ = self._find(image, place)
        return (rings, discs) if rings else None

    def _window(self, which: int, time: float) -> tuple[int, int, int, int] | None:
        """Where in the picture the puck (0) or the opponent (1) should be; None if that is not known."""
        there = (self._puck, self._opponent)[which].foretold(time)
        return self._windows[which].around(there.place, self._reach + ROOM * there.deviation) if there else None

    def _told(self, estimate: Estimate | None) -> Estimate | None:
        """With the calibration's error in the place's deviation, which no number of pictures makes less."""
        return estimate and replace(estimate, covariance=estimate.covariance + self._calibration)

    def _find(self, image: np.ndarray, window: tuple[int, int, int, int] | None) -> tuple[list[Ring], list[Disc]]:
        rings, rest = self._rings.find(image, self._bright.blobs(image, window))
        return rings, self._pucks.find(image, rest)


def _of_disc(disc: Disc) -> Sighting:
    return Sighting(disc.centre, disc.covariance, disc.deviation <= SURE_WITHIN)


def _of_ring(ring: Ring) -> Sighting:
    return Sighting(ring.centre, ring.covariance, True)
