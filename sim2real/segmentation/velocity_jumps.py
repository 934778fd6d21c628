"""Sudden changes of the puck's velocity: time, place and velocities with their joint covariance."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sim2real.recording.folder import Recording
from sim2real.segmentation.events import ContactEvent
from sim2real.segmentation.segments import Segments
from sim2real.segmentation.sensor_noise import MotionNoise
from sim2real.segmentation.tuned import SEGMENTATION
from sim2real.statistics.whitening import decorrelated

Side = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
ROUNDS = 3  # iterations, because the time of evaluation depends on where the motions meet, and vice versa


@dataclass(frozen=True)
class VelocityJump:
    """A contact with its velocities and their errors.

    `state` (7,): its time on the camera's clock [s], place (2) [m], velocity before (2) and after (2) [m/s];
    `covariance` (7, 7) of these; `launch`: number of its launch.
    """

    contact: ContactEvent
    state: np.ndarray
    covariance: np.ndarray
    launch: int

    @property
    def t(self) -> float:
        """Time [s] on the camera's clock."""
        return float(self.state[0])

    @property
    def place(self) -> np.ndarray:
        """Place (2,) [m] of the puck's centre."""
        return self.state[1:3]

    @property
    def v_in(self) -> np.ndarray:
        """Velocity (2,) [m/s] before."""
        return self.state[3:5]

    @property
    def v_out(self) -> np.ndarray:
        """Velocity (2,) [m/s] after."""
        return self.state[5:7]


def velocity_jumps(
    recording: Recording,
    segments: Segments,
    friction: float = 0.0,
    drag: float = 0.0,
    noise: MotionNoise | None = None,
) -> list[VelocityJump]:
    """Fit the contacts of a recording that have enough frames on both sides, in order of time.

    The motion on either side is a parabola plus the change of acceleration of a puck with `friction` [m/s^2] and `drag`
    [1/m]; by default there is no such change. `noise`: of the camera; by default the white noise of `segments`.
    """
    frames = recording.frames
    if frames is None or not segments.contacts:
        return []
    t, p = frames.t, np.stack([frames["puck_x"], frames["puck_y"]], axis=1)
    valid = np.flatnonzero(np.isfinite(p).all(axis=1) & ~segments.held & ~segments.wild)
    starts = {start for start, _ in segments.launches}
    edges = np.unique([0, len(t), *starts, *(contact.frames[1] for contact in segments.contacts)])
    found = []
    for contact in segments.contacts:
        k = int(np.searchsorted(edges, contact.frames[1]))
        if contact.where == "pushed" or k == 0 or k + 1 >= len(edges):
            continue
        left = valid[(valid >= edges[k - 1]) & (valid < edges[k])]
        right = valid[(valid >= edges[k]) & (valid < edges[k + 1])]
        left = left[t[left] > contact.t - SEGMENTATION.side_time][-SEGMENTATION.side_most :]
        right = right[t[right] < contact.t + SEGMENTATION.side_time][: SEGMENTATION.side_most]
        if min(len(left), len(right)) >= SEGMENTATION.side_least:
            state, covariance = _meet(
                t, p, left, right, contact.t, lambda u, q: _side(u, q, noise or segments.noise, friction, drag)
            )
            launch = int(np.searchsorted(sorted(starts), contact.frames[0], side="right"))
            found.append(VelocityJump(contact, state, covariance, launch))
    return found


def _meet(
    t: np.ndarray, p: np.ndarray, left: np.ndarray, right: np.ndarray, when: float, side: Side
) -> tuple[np.ndarray, np.ndarray]:
    """State (7,) and covariance (7, 7) of the contact at which the motions in the frames `left` and `right` meet.

    `side`: fits the frames on one side.
    """
    low, high = float(t[left[-1]]), float(t[right[0]])
    slack = 0.5 * (high - low)
    for _ in range(ROUNDS):
        a, a_spread = side(t[left] - when, p[left])
        b, b_spread = side(t[right] - when, p[right])
        sides = np.concatenate([a, b])  # place and velocity before, place and velocity after
        spread = np.zeros((8, 8))
        spread[:4, :4], spread[4:, 4:] = a_spread, b_spread
        sides, spread = _touching(sides, spread)
        later = _joined(sides)[0]
        when = float(np.clip(when + later, low - slack, high + slack))
    jacobian = np.zeros((7, 8))
    here = _joined(sides)
    for k in range(8):
        moved = sides.copy()
        moved[k] += 1e-6
        jacobian[:, k] = (_joined(moved) - here) / 1e-6
    here[0] = when
    return here, jacobian @ spread @ jacobian.T


def _touching(sides: np.ndarray, spread: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Condition both motions on meeting: their places across the change of velocity are equal."""
    change = sides[6:8] - sides[2:4]
    across = np.array([-change[1], change[0]]) / max(float(np.linalg.norm(change)), 1e-9)
    row = np.concatenate([-across, np.zeros(2), across, np.zeros(2)])
    gain = spread @ row / (row @ spread @ row)
    return sides - gain * (row @ sides), spread - np.outer(gain, row @ spread)


def _joined(sides: np.ndarray) -> np.ndarray:
    """The contact (7,) of two motions (8,), with its time relative to their common reference."""
    a, v_in, b, v_out = sides[:2], sides[2:4], sides[4:6], sides[6:8]
    change = v_out - v_in
    later = -float((b - a) @ change) / max(float(change @ change), 1e-9)
    place = (a + v_in * later + b + v_out * later) / 2
    return np.concatenate([[later], place, v_in, v_out])


def _side(
    u: np.ndarray, q: np.ndarray, noise: MotionNoise, friction: float, drag: float
) -> tuple[np.ndarray, np.ndarray]:
    """Place and velocity (4,), and their covariance (4, 4), at u = 0 of the motion through `q` (n, 2) [m] at `u` [s].

    The law s' = -(friction + drag s^2) of the speed s has s'' = 2 drag s (friction + drag s^2).
    """
    way, duration = q[-1] - q[0], max(float(np.ptp(u)), 1e-6)
    speed = float(np.linalg.norm(way)) / duration
    sigma = float(noise.std(speed))
    q = q - 2.0 * drag * (friction + drag * speed**2) * way / duration * u[:, None] ** 3 / 6.0
    rows = np.column_stack([np.ones_like(u), u, u * u / 2, q])
    basis, q = np.split(decorrelated(noise.correlation(u), rows), [3], axis=1)
    inverse = np.linalg.inv(basis.T @ basis + np.diag([0.0, 0.0, (sigma / SEGMENTATION.free_acceleration) ** 2]))
    fit = inverse @ basis.T @ q
    covariance = np.kron(inverse[:2, :2], np.eye(2)) * sigma**2
    return fit[:2].ravel(), covariance
