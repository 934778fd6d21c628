"""A Kalman tracker of one object: its place and velocity with their covariance, and whether they are known.

The motion model is a constant velocity, or that of a law which slows the object down, with white acceleration; it
holds between contacts. A measurement outside of
the prediction's gate is a contact, after which a new track begins. An object that is not measured is hidden under the
gantry, beside the mallet that may strike it at any time: its state is unknown, and the track resumes at any place that
the object can have reached since it was last measured.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from puckpilot_env.kernel import kernel
from sim2real.vision.track.covariance import deviation

GATE = 16.0  # squared Mahalanobis distance up to which a measurement belongs to the track
CLOSE = 0.01  # m, predicted standard deviation beyond which only unambiguous measurements are taken,
FASTEST = 15.0  # m/s, and only if the object can have reached their place at this speed
ANY_SPEED = 5.0  # m/s, prior standard deviation of the velocity
Coast = Callable[[np.ndarray, np.ndarray, float], tuple[np.ndarray, np.ndarray]]
"""Place (2,) [m] and velocity (2,) [m/s] after a time [s] without contacts."""


def straight_on(place: np.ndarray, velocity: np.ndarray, time: float) -> tuple[np.ndarray, np.ndarray]:
    """Place (2,) [m] and velocity (2,) [m/s] after a `time` [s] at a constant velocity."""
    return place + time * velocity, velocity


@dataclass(frozen=True)
class Measurement:
    """A measurement of the object in one picture.

    place: (2,) [m]; covariance: (2, 2) of the place [m^2]; sure: whether it can be nothing but the object.
    """

    place: np.ndarray
    covariance: np.ndarray
    sure: bool


@dataclass(frozen=True)
class TrackState:
    """The state of a track.

    time: of the state [s]; place: (2,) [m]; velocity: (2,) [m/s]; covariance: (4, 4) of place and velocity [m, m/s];
    pictures: number of measurements in this track; newest: the last of them.
    """

    time: float
    place: np.ndarray
    velocity: np.ndarray
    covariance: np.ndarray
    pictures: int
    newest: Measurement | None = None

    @property
    def confirmed(self) -> bool:
        """Whether the track has two measurements or more; a single one may be false."""
        return self.pictures >= 2

    @property
    def deviation(self) -> float:
        """Standard deviation of the place in the least certain direction [m]."""
        return deviation(self.covariance)

    def predicted(self, time: float, power: float, coast: Coast = straight_on) -> TrackState:
        """The state at a later time [s], for a white acceleration of this spectral density [m^2/s^3] about `coast`."""
        dt, covariance = time - self.time, np.empty((4, 4))
        _grow(self.covariance, dt, power, covariance)
        return TrackState(time, *coast(self.place, self.velocity, dt), covariance, self.pictures)

    def updated(self, measurement: Measurement) -> TrackState:
        """The state after a measurement of the same time (Kalman 1960)."""
        state, covariance = np.concatenate([self.place, self.velocity]), np.empty((4, 4))
        _correct(state, self.covariance, measurement.place, measurement.covariance, covariance)
        return TrackState(self.time, state[:2], state[2:], covariance, self.pictures + 1, measurement)

    def squared_distance(self, measurement: Measurement) -> float:
        """The squared Mahalanobis distance to a measurement of the same time."""
        return _squared_distance(self.place, self.covariance, measurement.place, measurement.covariance)


class KalmanTracker:
    """Tracks one object through pictures in order of time.

    power: spectral density of the white acceleration between contacts [m^2/s^3]; coast: its motion without that.
    """

    def __init__(self, power: float, coast: Coast = straight_on) -> None:
        self._power, self._coast = power, coast
        self._last: TrackState | None = None  # at the last measurement
        self._time = -math.inf  # of the last picture
        self._predicted: TrackState | None = None  # from `_last`, for the time that was asked for last

    def predict(self, time: float) -> TrackState | None:
        """The predicted state at a time [s] without contacts; None if the present state is unknown."""
        return self._ahead(self._last, time) if self._last and self.in_sight and self._last.confirmed else None

    def reachable(self, time: float) -> tuple[np.ndarray, float] | None:
        """Where the object can be at a time [s]: the place (2,) of its last measurement [m] and how far from there [m];
        None before the first."""
        return (self._last.place, FASTEST * (time - self._last.time)) if self._last else None

    @property
    def confirmed(self) -> bool:
        """Whether the object was measured twice or more, so that it is where it can have come since."""
        return self._last is not None and self._last.confirmed

    def update(self, time: float, measurements: Sequence[Measurement]) -> TrackState | None:
        """Update the track with the measurements of a picture at `time` [s].

        Returns the state, None if it is unknown. Raises ValueError if the picture is not later than the last one.
        """
        if time <= self._time:
            raise ValueError(f"a picture of {time:.6f} s after one of {self._time:.6f} s; expected later ones")
        self._last, self._time, self._predicted = self._next(time, measurements), time, None
        return self._last if self._last and self.in_sight and self._last.confirmed else None

    @property
    def in_sight(self) -> bool:
        """Whether the object was measured in the last picture."""
        return self._last is not None and self._last.time == self._time

    @property
    def measurement(self) -> Measurement | None:
        """What was taken for the object in the last picture, whether the track is confirmed or not; None if nothing."""
        return self._last.newest if self._last and self.in_sight else None

    def _ahead(self, last: TrackState, time: float) -> TrackState:
        """The last state as it is at a later time [s]; it is asked for twice, to search in a picture and to update."""
        if self._predicted is None or self._predicted.time != time:
            self._predicted = last.predicted(time, self._power, self._coast)
        return self._predicted

    def _next(self, time: float, measurements: Sequence[Measurement]) -> TrackState | None:
        before = self._last
        sure = [one for one in measurements if one.sure]
        if before is None:
            return _new_track(time, sure)
        here = self._ahead(before, time)
        close = here.deviation <= CLOSE
        fitting = [one for one in measurements if here.squared_distance(one) <= GATE] if close else []
        if fitting:
            return here.updated(min(fitting, key=here.squared_distance))
        reachable = [one for one in sure if _apart(one, before) <= FASTEST * (time - before.time)]
        if len(reachable) == 1:
            if self.in_sight and not close:
                return here.updated(reachable[0])
            return _new_track(time, reachable, before.pictures if self.in_sight else 0)  # a contact
        return before if before.confirmed else _new_track(time, sure)


@kernel
def _grow(before, dt, power, after):
    """Write the covariance (4, 4) of place and velocity a time `dt` [s] later into `after`: F P F' + Q of the model
    with white acceleration of spectral density `power` [m^2/s^3]."""
    for i in range(2):
        for j in range(2):
            a, b, c, d = before[i, j], before[i, j + 2], before[i + 2, j], before[i + 2, j + 2]
            noise = power * dt if i == j else 0.0
            after[i, j] = a + dt * (b + c + dt * d) + noise * dt * dt / 3.0
            after[i, j + 2] = b + dt * d + noise * dt / 2.0
            after[i + 2, j] = c + dt * d + noise * dt / 2.0
            after[i + 2, j + 2] = d + noise


@kernel
def _inverse(covariance, error):
    """The inverse of the innovation covariance, place's plus measurement's: xx, xy, yy [1/m^2]."""
    xx, xy = covariance[0, 0] + error[0, 0], covariance[0, 1] + error[0, 1]
    yy = covariance[1, 1] + error[1, 1]
    det = xx * yy - xy * xy
    return yy / det, -xy / det, xx / det


@kernel
def _squared_distance(place, covariance, seen, error):
    """The squared Mahalanobis distance of a measured place (2,) [m] with covariance `error` (2, 2) [m^2]."""
    xx, xy, yy = _inverse(covariance, error)
    x, y = seen[0] - place[0], seen[1] - place[1]
    return xx * x * x + 2.0 * xy * x * y + yy * y * y


@kernel
def _correct(state, before, seen, error, after):
    """The Kalman update of place and velocity (4,), in place, by a measured place; writes the covariance (4, 4) into
    `after`."""
    xx, xy, yy = _inverse(before, error)
    x, y = seen[0] - state[0], seen[1] - state[1]
    for i in range(4):
        by_x, by_y = before[i, 0] * xx + before[i, 1] * xy, before[i, 0] * xy + before[i, 1] * yy
        state[i] += by_x * x + by_y * y
        for j in range(i + 1):
            after[i, j] = after[j, i] = before[i, j] - by_x * before[j, 0] - by_y * before[j, 1]


def _apart(measurement: Measurement, state: TrackState) -> float:
    return float(np.linalg.norm(measurement.place - state.place))


def first_state(time: float, measurement: Measurement, pictures: int = 0) -> TrackState:
    """The state at a time [s] of an object that was measured then alone; pictures: number of measurements before, which
    say nothing of the state any more."""
    covariance = np.diag([0.0, 0.0, ANY_SPEED**2, ANY_SPEED**2])
    covariance[:2, :2] = measurement.covariance
    return TrackState(time, measurement.place, np.zeros(2), covariance, pictures + 1, measurement)


def _new_track(time: float, measurements: list[Measurement], pictures: int = 0) -> TrackState | None:
    """A new track from the only measurement of a picture; None without one, or with several, which are ambiguous."""
    return first_state(time, measurements[0], pictures) if len(measurements) == 1 else None
