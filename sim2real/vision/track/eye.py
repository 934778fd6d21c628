"""From a picture to where puck and opponent are: outlines, edges, ring and disc, and what was known before."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.vision.locate import Grid, Locator
from sim2real.vision.track.bright import LEVEL, Bright
from sim2real.vision.track.disc import Disc
from sim2real.vision.track.follow import Estimate, Follower, Sighting
from sim2real.vision.track.puck import PuckFinder
from sim2real.vision.track.ring import Ring, RingFinder
from sim2real.vision.track.window import Windows

SURE_SEEN = 0.3  # of the puck's rim, from which on it can be nothing else
SURE_WITHIN = 0.25e-3  # m, standard deviation of a sure sighting at most
PUCK_POWER, OPPONENT_POWER = 0.02, 5.0  # m^2/s^3, of what changes their velocities between contacts
AROUND = 2.0  # radii round where something should be that are looked at
ROOM = 4.0  # standard deviations more


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
        puck_height: float, ring_height: float, level: float = LEVEL,
    ) -> None:  # fmt: skip
        self._reach = AROUND * puck_radius
        self._windows = [Windows(locator, height, length, width) for height in (puck_height, ring_height)]
        self._bright = Bright(locator, size, length, width, ring_height, level)
        self._pucks = PuckFinder(Grid(locator, puck_height, size).places, puck_radius)
        self._rings = RingFinder(Grid(locator, ring_height, size).places)
        self._puck, self._opponent = Follower(PUCK_POWER), Follower(OPPONENT_POWER)

    def look(self, image: np.ndarray, time: float) -> Seen:
        """What this picture, uint8 (rows, columns), adds."""
        rings, discs = self._near(image, time) or self._find(image, None)
        puck = self._puck.see(time, [_of_disc(disc) for disc in discs])
        opponent = self._opponent.see(time, [_of_ring(ring) for ring in rings])
        return Seen(puck, opponent, len(discs))

    def _near(self, image: np.ndarray, time: float) -> tuple[list[Ring], list[Disc]] | None:
        """What is seen where both should be; None if that is not known, or either is not there."""
        found = []
        for follower, windows in zip((self._puck, self._opponent), self._windows, strict=True):
            there = follower.foretold(time)
            window = windows.around(there.place, self._reach + ROOM * there.deviation) if there else None
            if window is None:
                return None
            found.append(self._find(image, window))
        (_, discs), (rings, _) = found  # where both are near, each window shows both
        if not rings or not any(_of_disc(disc).sure for disc in discs):
            return None
        return rings, discs

    def _find(self, image: np.ndarray, window: tuple[int, int, int, int] | None) -> tuple[list[Ring], list[Disc]]:
        rings, rest = self._rings.find(image, self._bright.blobs(image, window))
        return rings, self._pucks.find(image, rest)


def _of_disc(disc: Disc) -> Sighting:
    return Sighting(disc.centre, disc.covariance, disc.seen >= SURE_SEEN and disc.deviation <= SURE_WITHIN)


def _of_ring(ring: Ring) -> Sighting:
    return Sighting(ring.centre, ring.covariance, True)
