"""From a picture to the states of puck and opponent: search regions, blobs, ring and disc, Kalman trackers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim2real.vision.locate import Locator, PlaceGrid
from sim2real.vision.mosaic import GreyOfMosaic
from sim2real.vision.track.blobs import LEVEL, Blob, BlobDetector
from sim2real.vision.track.disc import Disc
from sim2real.vision.track.film import Film, FilmGauge
from sim2real.vision.track.kalman_tracker import KalmanTracker, Measurement, TrackState, first_state
from sim2real.vision.track.puck import PuckFinder
from sim2real.vision.track.ring import Ring, RingFinder
from sim2real.vision.track.search.object_search import ObjectSearch
from sim2real.vision.track.search.parts import Region, SearchInParts
from sim2real.vision.track.search.regions import SearchRegions

SURE_WITHIN = 0.25e-3  # m, greatest standard deviation of a disc that can only be the puck
PUCK_POWER, OPPONENT_POWER = 0.02, 5.0  # m^2/s^3, spectral density of the white acceleration between contacts
AROUND = 2.0  # puck radii from the place of an object to the edge of its search region
PARTS = 4  # of the picture, one of which is searched for an object that can be anywhere


@dataclass(frozen=True)
class Detections:
    """The result for one picture.

    puck, opponent: the states of the tracks, None where the place is unknown; pucks: number of candidates for the puck;
    measured_puck, measured_opponent: what the tracks took from this picture alone, None where they took nothing.
    """

    puck: TrackState | None
    opponent: TrackState | None
    pucks: int
    measured_puck: Measurement | None = None
    measured_opponent: Measurement | None = None


class Detector:
    """Detects puck and opponent in the pictures of one camera and tracks both."""

    def __init__(
        self, locator: Locator, size: tuple[int, int], *, length: float, width: float, film: Film | FilmGauge,
        puck_height: float, ring_height: float, level: float = LEVEL, calibration_error: float = 0.0,
        mosaic: bool = False, live: bool = False,
    ) -> None:  # fmt: skip
        """size: columns and rows of the pictures; length, width: of the table [m]; film: of the puck, or the gauge that
        measures it; puck_height, ring_height: of the puck's top and of the opponent's ring above the table [m]; level:
        see `blobs.LEVEL`; calibration_error: standard deviation along each axis of the error common to all pictures
        [m]; mosaic: whether pictures are raw, of format BayerRG8; live: whether time presses, so that the puck too is
        searched by parts where it can be anywhere."""
        self._blobs = BlobDetector(locator, size, length, width, ring_height, level)
        self._pucks = PuckFinder(PlaceGrid(locator, puck_height, size).places, film)
        self._rings = RingFinder(PlaceGrid(locator, ring_height, size).places)
        of_puck, of_ring = (SearchRegions(locator, height, length, width) for height in (puck_height, ring_height))
        self._puck = self._search_of(PUCK_POWER, of_puck, PARTS if live else 1)
        self._opponent = self._search_of(OPPONENT_POWER, of_ring, PARTS)
        self._calibration = np.diag([calibration_error**2, calibration_error**2, 0.0, 0.0])
        self._grey = GreyOfMosaic(size) if mosaic else None
        self._pictures, self._several = 0, False  # searched; whether the last one showed several pucks

    def detect(self, image: np.ndarray, time: float) -> Detections:
        """Detect in a picture uint8 (rows, columns) of mid-exposure time `time` [s], and update the tracks. Pictures
        come in order of time; ValueError otherwise."""
        rings = self._search_rings(image, time)
        discs = self._search_discs(image, time, rings)
        self._pictures, self._several = self._pictures + 1, sum(_disc_measurement(disc).sure for disc in discs) > 1
        puck = self._puck.tracker.update(time, [_disc_measurement(disc) for disc in discs])
        opponent = self._opponent.tracker.update(time, [_ring_measurement(ring) for ring in rings])
        return Detections(
            self._with_calibration(puck), self._with_calibration(opponent), len(discs),
            self._puck.tracker.measurement, self._opponent.tracker.measurement,
        )  # fmt: skip

    def keep_warm(self, image: np.ndarray, time: float) -> None:
        """Search as `detect` would, to no effect: what a search needs is in the processor's caches then, and one that
        comes soon takes half the time."""
        region = self._opponent.predicted(time, self._room)
        rings = [] if region is None else self._rings_in(image, region)
        region = self._puck.predicted(time, self._room) or self._puck.part(time, self._room, self._pictures)
        self._find(image, region, rings, measure=False)

    def detect_alone(self, image: np.ndarray, time: float) -> Detections:
        """Detect in a picture uint8 (rows, columns) that has nothing to do with any other: the best candidates, be they
        sure or not, with a velocity of 0 that is unknown."""
        rings, discs = self._find(image, None)
        puck = first_state(time, _disc_measurement(discs[0])) if discs else None
        opponent = first_state(time, _ring_measurement(rings[0])) if rings else None
        return Detections(self._with_calibration(puck), self._with_calibration(opponent), len(discs))

    def count_pucks(self, image: np.ndarray) -> int:
        """The number of discs in a whole picture uint8 (rows, columns) that can only be pucks; no track is updated."""
        return sum(_disc_measurement(disc).sure for disc in self._find(image, None)[1])

    def _search_of(self, power: float, regions: SearchRegions, parts: int) -> ObjectSearch:
        overlap = regions.longest_side(self._room)
        return ObjectSearch(KalmanTracker(power), regions, SearchInParts(self._blobs.box, parts, overlap))

    def _search_rings(self, image: np.ndarray, time: float) -> list[Ring]:
        """The rings where the opponent is likely to be or, if it is not there, in a part of where it can be."""
        for region in self._opponent.likely(time, self._room):
            if rings := self._rings_in(image, region):
                return rings
        return self._rings_in(image, self._opponent.part(time, self._room, self._pictures))

    def _search_discs(self, image: np.ndarray, time: float, rings: list[Ring]) -> list[Disc]:
        """The discs beside known rings where the puck is likely to be or, if it is not there, in a part of where it can
        be; in all of that while there were several in the last picture, of which a part might show one."""
        for region in self._puck.likely(time, self._room):
            discs = self._find(image, region, rings)[1]
            if any(_disc_measurement(disc).sure for disc in discs):
                return discs
        if self._several:
            return self._find(image, self._puck.possible(time, self._room), rings)[1]
        return self._find(image, self._puck.part(time, self._room, self._pictures), rings)[1]

    def _rings_in(self, image: np.ndarray, region: Region) -> list[Ring]:
        return self._rings.find(*self._blobs_in(image, region))[0]

    @property
    def _room(self) -> float:
        """From the place of an object to the edge of its search region [m]."""
        return AROUND * self._pucks.film.radius

    def _with_calibration(self, state: TrackState | None) -> TrackState | None:
        """The state with the calibration's error added to its covariance, which no number of pictures reduces."""
        return state and replace(state, covariance=state.covariance + self._calibration)

    def _find(
        self, image: np.ndarray, region: Region | None, known: Sequence[Ring] = (), measure: bool = True
    ) -> tuple[list[Ring], list[Disc]]:
        """The rings in a region, None for the whole, that are not known yet, and the discs beside all; measure: whether
        the puck's film may be measured by them."""
        image, blobs = self._blobs_in(image, region)
        for ring in known:
            blobs = self._rings.beside(ring, blobs)
        rings, rest = self._rings.find(image, blobs)
        return rings, self._pucks.find(image, rest, measure)

    def _blobs_in(self, image: np.ndarray, region: Region | None) -> tuple[np.ndarray, list[Blob]]:
        """The picture without its mosaic, and the blobs in a region of it, None for the whole."""
        image = self._grey.part(image, region) if self._grey else image
        return image, self._blobs.blobs(image, region)


def _disc_measurement(disc: Disc) -> Measurement:
    return Measurement(disc.centre, disc.covariance, disc.deviation <= SURE_WITHIN)


def _ring_measurement(ring: Ring) -> Measurement:
    return Measurement(ring.centre, ring.covariance, True)
