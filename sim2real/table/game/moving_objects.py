"""Estimates of puck and opponent from camera frames, and their motion predicted to a later moment."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from puckpilot_env.game.predict import expected_place
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.sliding import glide
from puckpilot_env.physics.vector import size
from sim2real.table.backend import Motion, Place
from sim2real.vision.track.detector import OPPONENT_POWER, PUCK_POWER
from sim2real.vision.track.kalman_tracker import (
    ANY_SPEED,
    Coast,
    KalmanTracker,
    Measurement,
    TrackState,
    straight_on,
)

DEVIATION = 0.0003  # m, of a measured place, each coordinate
WALL = 0.01  # m from where a wall would have sent it
COVARIANCE = DEVIATION**2 * np.eye(2)


class SeenObject:
    """An object that the camera sees: the newest state of its track, kept while it is hidden.

    power: of the track's white acceleration [m^2/s^3]; expected: its motion a time [s] after another without contacts
    with mallets; coast: the same without any contact, which the track follows.
    """

    def __init__(self, power: float, expected: Callable[[Motion, float], Motion], coast: Coast = straight_on) -> None:
        self._power, self._expected, self._coast = power, expected, coast
        self.forget()

    def forget(self) -> None:
        """Begin anew: the object was put somewhere else."""
        self._tracker = KalmanTracker(self._power, self._coast)
        self.state: TrackState | None = None
        self._velocity = np.zeros(2)

    def update(self, time: float, place: Place | None, covariance: np.ndarray | None = None) -> None:
        """Take a frame of `time` [s], in which the object is at `place` [m], or not seen.

        covariance: (2, 2) of the place [m^2], COVARIANCE if None.
        """
        covariance = COVARIANCE if covariance is None else covariance
        seen = [] if place is None else [Measurement(np.array(place), covariance, True)]
        before, self.state = self.state, self._tracker.update(time, seen) or self.state
        if self.state is None or self.state is before:
            return
        began_anew = self.state.covariance[2, 2] > 0.5 * ANY_SPEED**2
        if began_anew and before is not None:
            self._velocity = self._after_contact(before, self.state)
        else:
            self._velocity = self.state.velocity

    def _after_contact(self, before: TrackState, now: TrackState) -> np.ndarray:
        """The velocity (2,) after a contact since the frame before: off a wall, if that is where it would be, else the
        mean of the frames' interval."""
        (x, y), (vx, vy) = before.place, self._velocity
        x, y, vx, vy = self._expected((float(x), float(y), float(vx), float(vy)), now.time - before.time)
        if np.hypot(x - now.place[0], y - now.place[1]) < WALL:
            return np.array([vx, vy])
        return (now.place - before.place) / (now.time - before.time)

    def unseen_for(self, time: float) -> float:
        """How long before `time` [s] it was seen last [s]; infinite if never."""
        return math.inf if self.state is None else time - self.state.time

    def motion(self) -> Motion | None:
        """The motion at the newest frame in which it was seen; None before the second."""
        if self.state is None:
            return None
        (x, y), (vx, vy) = self.state.place, self._velocity
        return float(x), float(y), float(vx), float(vy)


def _straight_on(motion: Motion, ahead: float) -> Motion:
    x, y, vx, vy = motion
    return x + ahead * vx, y + ahead * vy, vx, vy


class SeenTable:
    """Puck and opponent as seen.

    p: the table's parameters, as the player may know them, with which the free puck is predicted.
    """

    def __init__(self, p: np.void) -> None:
        self._p, self._params = p, np.array([p])
        self.puck = SeenObject(PUCK_POWER, lambda motion, ahead: _expected(*motion, self._params, ahead), self._glide)
        self.opponent = SeenObject(OPPONENT_POWER, _straight_on)

    def _glide(self, place: np.ndarray, velocity: np.ndarray, ahead: float) -> tuple[np.ndarray, np.ndarray]:
        """A track of constant velocity would lag a fast puck, which slows down, by some centimetres a second."""
        x, y, vx, vy = _gliding(*place, *velocity, self._params, ahead)
        return np.array([x, y]), np.array([vx, vy])

    def forget(self) -> None:
        """Begin anew."""
        self.puck.forget()
        self.opponent.forget()

    def puck_at(self, time: float) -> Motion | None:
        """The puck's motion at `time` [s] if no mallet touches it; None before it was seen twice."""
        found = self.puck.motion()
        return found and _expected(*found, self._params, max(self.puck.unseen_for(time), 0.0))

    def opponent_at(self, time: float) -> Motion | None:
        """The opponent's motion at `time` [s] if it goes straight on for a moment; None before it was seen twice."""
        found = self.opponent.motion()
        if found is None:
            return None
        x, y, vx, vy = found
        ahead = min(max(self.opponent.unseen_for(time), 0.0), 0.05)
        low_x, high_x = 0.5 * self._p["length"], float(self._p["length"])
        ahead_x, ahead_y = x + ahead * vx, y + ahead * vy
        return min(max(ahead_x, low_x), high_x), min(max(ahead_y, 0.0), float(self._p["width"])), vx, vy


@kernel
def _expected(x, y, vx, vy, params, ahead):
    return expected_place(x, y, vx, vy, params[0], ahead)


@kernel
def _gliding(x, y, vx, vy, params, ahead):
    """Place [m] and velocity [m/s] after `ahead` [s] on a table without walls."""
    speed = size(vx, vy)
    if speed == 0.0:
        return x, y, vx, vy
    travel, slower = glide.advance(speed, ahead, params[0].friction, params[0].drag)
    return x + vx / speed * travel, y + vy / speed * travel, vx / speed * slower, vy / speed * slower
