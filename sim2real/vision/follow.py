"""Follows one thing through the pictures: where it is, how fast, how surely, and when that is not known.

Between contacts things on the table go nearly straight; a contact is a sighting that the path before did not foretell.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

UNSTEADY = 4.0  # m/s^2: standard deviation of what changes a velocity between contacts, white over UNSTEADY_TIME
UNSTEADY_TIME = 0.05  # s
GATE = 16.0  # square of the distance in standard deviations at which a sighting still fits the path
SLACK = 1e-3  # m beside that: a contact between two pictures moves a thing a little off its path
FASTEST = 15.0  # m/s
LOST = 0.06  # s unseen: whatever is seen surely from then on is it
LEAST_SURE = 0.03  # m: with a greater standard deviation it is not known where it is
ANY_SPEED = 5.0  # m/s, standard deviation of a velocity of which nothing is known


@dataclass(frozen=True)
class Sighting:
    """Something in one picture: its place (2,) [m], the covariance (2, 2) [m^2], and whether it can be nothing else."""

    place: np.ndarray
    covariance: np.ndarray
    sure: bool


@dataclass(frozen=True)
class Estimate:
    """Where something is at `time` [s]: place (2,) [m] and velocity (2,) [m/s], their covariance (4, 4), when it was
    `last` seen [s], and in how many pictures so far."""

    time: float
    place: np.ndarray
    velocity: np.ndarray
    covariance: np.ndarray
    last: float
    pictures: int

    @property
    def seen(self) -> bool:
        """Whether it was seen in this very picture."""
        return self.last == self.time

    @property
    def deviation(self) -> float:
        """Standard deviation of its place in the least certain direction [m]."""
        return float(np.sqrt(np.linalg.eigvalsh(self.covariance[:2, :2])[-1]))

    @property
    def known(self) -> bool:
        """Whether it is known where it is. One picture could err."""
        return self.pictures >= 2 and self.deviation <= LEAST_SURE

    def after(self, time: float) -> Estimate:
        """Where it will be, if nothing touches it."""
        dt = time - self.time
        on = np.eye(4)
        on[0, 2] = on[1, 3] = dt
        power = UNSTEADY**2 * UNSTEADY_TIME
        grown = power * np.kron([[dt**3 / 3.0, dt**2 / 2.0], [dt**2 / 2.0, dt]], np.eye(2))
        covariance = on @ self.covariance @ on.T + grown
        return replace(self, time=time, place=self.place + dt * self.velocity, covariance=covariance)

    def corrected(self, sighting: Sighting) -> Estimate:
        """With a sighting of the same time (Kalman 1960)."""
        gain = np.linalg.solve(self.covariance[:2, :2] + sighting.covariance, self.covariance[:2]).T
        off = sighting.place - self.place
        covariance = self.covariance - gain @ self.covariance[:2]
        return Estimate(
            self.time,
            self.place + gain[:2] @ off,
            self.velocity + gain[2:] @ off,
            0.5 * (covariance + covariance.T),
            self.time,
            self.pictures + 1,
        )

    def far(self, sighting: Sighting) -> float:
        """Square of the distance to a sighting of the same time, in standard deviations."""
        off = sighting.place - self.place
        spread = self.covariance[:2, :2] + sighting.covariance + SLACK**2 * np.eye(2)
        return float(off @ np.linalg.solve(spread, off))


class Follower:
    """Give it the sightings of every picture, in order of time."""

    def __init__(self) -> None:
        self._now: Estimate | None = None

    def foretold(self, time: float) -> Estimate | None:
        """Where it should be at a time; None where nothing is followed."""
        return self._now.after(time) if self._now else None

    def see(self, time: float, sightings: Sequence[Sighting]) -> Estimate | None:
        """What is known after a picture, None if nothing is. ValueError if a picture is not later than the last."""
        before = self._now
        if before and time <= before.time:
            raise ValueError(f"a picture of {time:.6f} s after one of {before.time:.6f} s; expected later ones")
        self._now = self._next(time, sightings)
        return self._now if self._now and self._now.known else None

    def _next(self, time: float, sightings: Sequence[Sighting]) -> Estimate | None:
        before = self._now
        sure = [one for one in sightings if one.sure]
        if before is None:
            return _begun(time, sure[0]) if sure else None
        here = before.after(time)
        fitting = min(sightings, key=here.far, default=None)
        if fitting is not None and here.far(fitting) <= GATE:
            return here.corrected(fitting)
        reachable = [one for one in sure if _apart(one, before) <= FASTEST * (time - before.last) + SLACK]
        if reachable:  # something touched it
            return _touched(before, time, min(reachable, key=lambda one: _apart(one, before)))
        if time - before.last > LOST or before.pictures < 2:
            return _begun(time, sure[0]) if sure else (here if before.pictures >= 2 else None)
        return here


def _apart(sighting: Sighting, estimate: Estimate) -> float:
    return float(np.linalg.norm(sighting.place - estimate.place))


def _begun(time: float, sighting: Sighting) -> Estimate:
    covariance = np.diag([0.0, 0.0, ANY_SPEED**2, ANY_SPEED**2])
    covariance[:2, :2] = sighting.covariance
    return Estimate(time, sighting.place, np.zeros(2), covariance, time, 1)


def _touched(before: Estimate, time: float, sighting: Sighting) -> Estimate:
    """Its way goes on from where it was seen, at a velocity of which little is known."""
    return replace(_begun(time, sighting), pictures=before.pictures + 1)
