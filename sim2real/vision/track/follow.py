"""Follows one thing through the pictures: where it is, how fast, how surely, and when that is not known.

Between contacts things on the table go nearly straight; a contact is a sighting that the path before did not foretell.
What is not seen is under the gantry, beside the very mallet that may strike it at any moment: it is not known, and
comes out wherever it can have gone since it was seen last.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from puckpilot_env.kernel import kernel
from sim2real.vision.track.two_by_two import deviation

GATE = 16.0  # square of the distance in standard deviations at which a sighting still fits the path
CLOSE = 0.01  # m: what is known no better, standard deviation, is followed by sure sightings alone,
FASTEST = 15.0  # m/s: if it can have gone there since it was seen last
ANY_SPEED = 5.0  # m/s, standard deviation of a velocity of which nothing is known


@dataclass(frozen=True)
class Sighting:
    """Something in one picture: its place (2,) [m], the covariance (2, 2) [m^2], and whether it can be nothing else."""

    place: np.ndarray
    covariance: np.ndarray
    sure: bool


@dataclass(frozen=True)
class Estimate:
    """Where something is at `time` [s], when it was seen last: place (2,) [m] and velocity (2,) [m/s], their covariance
    (4, 4), and in how many pictures it was seen."""

    time: float
    place: np.ndarray
    velocity: np.ndarray
    covariance: np.ndarray
    pictures: int

    @property
    def known(self) -> bool:
        """Whether two pictures agree on it, since one could err."""
        return self.pictures >= 2

    @property
    def deviation(self) -> float:
        """Standard deviation of its place in the least certain direction [m]."""
        return deviation(self.covariance)

    def after(self, time: float, power: float) -> Estimate:
        """Where it will be, if what changes its velocity is white and has this power [m^2/s^3]."""
        dt, covariance = time - self.time, np.empty((4, 4))
        _grow(self.covariance, dt, power, covariance)
        return Estimate(time, self.place + dt * self.velocity, self.velocity, covariance, self.pictures)

    def corrected(self, sighting: Sighting) -> Estimate:
        """With a sighting of the same time (Kalman 1960)."""
        state, covariance = np.concatenate([self.place, self.velocity]), np.empty((4, 4))
        _correct(state, self.covariance, sighting.place, sighting.covariance, covariance)
        return Estimate(self.time, state[:2], state[2:], covariance, self.pictures + 1)

    def far(self, sighting: Sighting) -> float:
        """Square of the distance to a sighting of the same time, in standard deviations."""
        return _far(self.place, self.covariance, sighting.place, sighting.covariance)


class Follower:
    """Give it the sightings of every picture, in order of time. `power` [m^2/s^3]: of what changes the velocity between
    contacts."""

    def __init__(self, power: float) -> None:
        self._power = power
        self._last: Estimate | None = None  # as it was when it was seen last
        self._time = -math.inf  # of the last picture

    def foretold(self, time: float) -> Estimate | None:
        """Where it should be at a time, if nothing touches it; None where it is not known now."""
        return self._last.after(time, self._power) if self._last and self.in_sight and self._last.known else None

    def see(self, time: float, sightings: Sequence[Sighting]) -> Estimate | None:
        """What is known after a picture, None if nothing is. ValueError if a picture is not later than the last."""
        if time <= self._time:
            raise ValueError(f"a picture of {time:.6f} s after one of {self._time:.6f} s; expected later ones")
        self._last, self._time = self._next(time, sightings), time
        return self._last if self._last and self.in_sight and self._last.known else None

    @property
    def in_sight(self) -> bool:
        """Whether it was seen in the last picture."""
        return self._last is not None and self._last.time == self._time

    def _next(self, time: float, sightings: Sequence[Sighting]) -> Estimate | None:
        before = self._last
        sure = [one for one in sightings if one.sure]
        if before is None:
            return _begun(time, sure)
        here = before.after(time, self._power)
        close = here.deviation <= CLOSE
        fitting = [one for one in sightings if here.far(one) <= GATE] if close else []
        if fitting:
            return here.corrected(min(fitting, key=here.far))
        reachable = [one for one in sure if _apart(one, before) <= FASTEST * (time - before.time)]
        if len(reachable) == 1:
            if self.in_sight and not close:
                return here.corrected(reachable[0])
            return _begun(time, reachable, before.pictures if self.in_sight else 0)  # something struck it
        return before if before.known else _begun(time, sure)


@kernel
def _grow(before, dt, power, after):
    """Write the covariance (4, 4) of place and velocity a time later into `after`: what is off in the velocity moves
    the place, and white noise adds to both."""
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
    """Of the sum of a place's covariance and a sighting's (2, 2): xx, xy, yy [1/m^2]."""
    xx, xy = covariance[0, 0] + error[0, 0], covariance[0, 1] + error[0, 1]
    yy = covariance[1, 1] + error[1, 1]
    det = xx * yy - xy * xy
    return yy / det, -xy / det, xx / det


@kernel
def _far(place, covariance, seen, error):
    xx, xy, yy = _inverse(covariance, error)
    x, y = seen[0] - place[0], seen[1] - place[1]
    return xx * x * x + 2.0 * xy * x * y + yy * y * y


@kernel
def _correct(state, before, seen, error, after):
    """Correct place and velocity (4,) by a place that was seen, and write their covariance (4, 4) into `after`."""
    xx, xy, yy = _inverse(before, error)
    x, y = seen[0] - state[0], seen[1] - state[1]
    for i in range(4):
        by_x, by_y = before[i, 0] * xx + before[i, 1] * xy, before[i, 0] * xy + before[i, 1] * yy
        state[i] += by_x * x + by_y * y
        for j in range(i + 1):
            after[i, j] = after[j, i] = before[i, j] - by_x * before[j, 0] - by_y * before[j, 1]


def _apart(sighting: Sighting, estimate: Estimate) -> float:
    return float(np.linalg.norm(sighting.place - estimate.place))


def _begun(time: float, sightings: list[Sighting], pictures: int = 0) -> Estimate | None:
    """A new path; none from nothing, nor where there are several things that it could be."""
    if len(sightings) != 1:
        return None
    (sighting,) = sightings
    covariance = np.diag([0.0, 0.0, ANY_SPEED**2, ANY_SPEED**2])
    covariance[:2, :2] = sighting.covariance
    return Estimate(time, sighting.place, np.zeros(2), covariance, pictures + 1)
