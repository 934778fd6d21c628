"""From a picture to the states of puck and opponent: search regions, blobs, ring and disc, Kalman trackers."""

from __future__ import annotations

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
from sim2real.vision.track.search_region import SearchRegions

SURE_WITHIN = 0.25e-3  # m, greatest standard deviation of a disc that can only be the puck
PUCK_POWER, OPPONENT_POWER = 0.02, 5.0  # m^2/s^3, spectral density of the white acceleration between contacts
AROUND = 2.0  # puck radii of a search region round the predicted place,
ROOM = 4.0  # and standard deviations of the prediction beyond that
Region = tuple[int, int, int, int]  # of a picture: left, top, and the column and row after the last
EVERY = 4  # while no opponent is tracked, one in so many pictures is searched as a whole


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
        mosaic: bool = False,
    ) -> None:  # fmt: skip
        """size: columns and rows of the pictures; length, width: of the table [m]; film: of the puck, or the gauge that
        measures it; puck_height, ring_height: of the puck's top and of the opponent's ring above the table [m]; level:
        see `blobs.LEVEL`; calibration_error: standard deviation along each axis of the error common to all pictures
        [m]; mosaic: whether pictures are raw, of format BayerRG8."""
        self._regions = [SearchRegions(locator, height, length, width) for height in (puck_height, ring_height)]
        self._blobs = BlobDetector(locator, size, length, width, ring_height, level)
        self._pucks = PuckFinder(PlaceGrid(locator, puck_height, size).places, film)
        self._rings = RingFinder(PlaceGrid(locator, ring_height, size).places)
        self._puck, self._opponent = KalmanTracker(PUCK_POWER), KalmanTracker(OPPONENT_POWER)
        self._calibration = np.diag([calibration_error**2, calibration_error**2, 0.0, 0.0])
        self._grey = GreyOfMosaic(size) if mosaic else None
        self._partly = 0  # pictures since one was searched as a whole

    def detect(self, image: np.ndarray, time: float) -> Detections:
        """Detect in a picture uint8 (rows, columns) of mid-exposure time `time` [s], and update the tracks. Pictures
        come in order of time; ValueError otherwise."""
        near = self._find_in_regions(image, time)
        self._partly = 0 if near is None else self._partly + 1
        rings, discs = self._find(image, None) if near is None else near
        puck = self._puck.update(time, [_disc_measurement(disc) for disc in discs])
        opponent = self._opponent.update(time, [_ring_measurement(ring) for ring in rings])
        return Detections(
            self._with_calibration(puck), self._with_calibration(opponent), len(discs),
            self._puck.measurement, self._opponent.measurement,
        )  # fmt: skip

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

    def _find_in_regions(self, image: np.ndarray, time: float) -> tuple[list[Ring], list[Disc]] | None:
        """Rings and discs in the search regions; None if the whole picture has to be searched, because the puck's place
        is unknown, or puck or opponent is not in its region. While no opponent is tracked, one picture in EVERY is
        searched as a whole."""
        region = self._region(0, time)
        if region is None:
            return None
        _, discs = self._find(image, region)  # if both are near, each region shows both
        if not any(_disc_measurement(disc).sure for disc in discs):
            return None
        region = self._region(1, time)
        if region is None:
            return None if self._opponent.in_sight or self._partly >= EVERY - 1 else ([], discs)
        rings, _ = self._rings.find(*self._blobs_in(image, region))
        return (rings, discs) if rings else None

    def _region(self, which: int, time: float) -> Region | None:
        """The search region of the puck (0) or the opponent (1): left, top, and the column and row after the last; None
        if its place is unknown."""
        state, reach = (self._puck, self._opponent)[which].predict(time), AROUND * self._pucks.film.radius
        return self._regions[which].around(state.place, reach + ROOM * state.deviation) if state else None

    def _with_calibration(self, state: TrackState | None) -> TrackState | None:
        """The state with the calibration's error added to its covariance, which no number of pictures reduces."""
        return state and replace(state, covariance=state.covariance + self._calibration)

    def _find(self, image: np.ndarray, region: Region | None) -> tuple[list[Ring], list[Disc]]:
        image, blobs = self._blobs_in(image, region)
        rings, rest = self._rings.find(image, blobs)
        return rings, self._pucks.find(image, rest)

    def _blobs_in(self, image: np.ndarray, region: Region | None) -> tuple[np.ndarray, list[Blob]]:
        """The picture without its mosaic, and the blobs in a region of it, None for the whole."""
        image = self._grey.part(image, region) if self._grey else image
        return image, self._blobs.blobs(image, region)


def _disc_measurement(disc: Disc) -> Measurement:
    return Measurement(disc.centre, disc.covariance, disc.deviation <= SURE_WITHIN)


def _ring_measurement(ring: Ring) -> Measurement:
    return Measurement(ring.centre, ring.covariance, True)
