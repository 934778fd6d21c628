"""Sudden changes of the puck's velocity: when, where, the velocities, and the joint covariance of it all."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.hits import Hit
from sim2real.diagnose.pieces import Pieces
from sim2real.diagnose.sensor import Noise
from sim2real.recording import Recording

SIDE_TIME = 0.25  # s beside a hit, in which a puck that brakes little moves along a parabola
SIDE_MOST = 36  # frames of them at most
SIDE_LEAST = 4  # frames, one more than a parabola has numbers
BRAKING = 1.5  # m/s^2: a puck's acceleration is 0 give or take this
RECENTRED = 3  # rounds: where the motions are taken depends on when they meet, and that on them


@dataclass(frozen=True)
class Strike:
    """A hit. `state` (7,): its time on the camera's clock [s], place (2) [m], velocity before (2) and after (2) [m/s];
    `covariance` (7, 7) of these; `launch`: number of the unbroken motion that it belongs to."""

    hit: Hit
    state: np.ndarray
    covariance: np.ndarray
    launch: int

    @property
    def t(self) -> float:
        return float(self.state[0])

    @property
    def place(self) -> np.ndarray:
        return self.state[1:3]

    @property
    def v_in(self) -> np.ndarray:
        return self.state[3:5]

    @property
    def v_out(self) -> np.ndarray:
        return self.state[5:7]


def strikes(recording: Recording, pieces: Pieces) -> list[Strike]:
    """The hits of a recording that have frames enough on both sides, in the order of time."""
    frames = recording.frames
    if frames is None or not pieces.hits:
        return []
    t, p = frames.t, np.stack([frames["puck_x"], frames["puck_y"]], axis=1)
    valid = np.flatnonzero(np.isfinite(p).all(axis=1) & ~pieces.held & ~pieces.wild)
    starts = {start for start, _ in pieces.launches}
    edges = np.unique([0, len(t), *starts, *(hit.frames[1] for hit in pieces.hits)])
    found = []
    for hit in pieces.hits:
        k = int(np.searchsorted(edges, hit.frames[1]))
        if hit.where == "pushed" or k == 0 or k + 1 >= len(edges):
            continue
        left = valid[(valid >= edges[k - 1]) & (valid < edges[k])]
        right = valid[(valid >= edges[k]) & (valid < edges[k + 1])]
        left = left[t[left] > hit.t - SIDE_TIME][-SIDE_MOST:]
        right = right[t[right] < hit.t + SIDE_TIME][:SIDE_MOST]
        if min(len(left), len(right)) >= SIDE_LEAST:
            state, covariance = _meet(t, p, left, right, hit.t, pieces.noise)
            launch = int(np.searchsorted(sorted(starts), hit.frames[0], side="right"))
            found.append(Strike(hit, state, covariance, launch))
    return found


def _meet(t, p, left, right, when: float, noise: Noise) -> tuple[np.ndarray, np.ndarray]:
    """State and covariance of the hit at which the motions on both sides join."""
    low, high = float(t[left[-1]]), float(t[right[0]])
    slack = 0.5 * (high - low)
    for _ in range(RECENTRED):
        a, a_spread = _side(t[left] - when, p[left], noise)
        b, b_spread = _side(t[right] - when, p[right], noise)
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
    """Both given that the motions meet: across the change of velocity their places are the same."""
    change = sides[6:8] - sides[2:4]
    across = np.array([-change[1], change[0]]) / max(float(np.linalg.norm(change)), 1e-9)
    row = np.concatenate([-across, np.zeros(2), across, np.zeros(2)])
    gain = spread @ row / (row @ spread @ row)
    return sides - gain * (row @ sides), spread - np.outer(gain, row @ spread)


def _joined(sides: np.ndarray) -> np.ndarray:
    """The hit (7,) of two motions (8,), its time after their common reference."""
    a, v_in, b, v_out = sides[:2], sides[2:4], sides[4:6], sides[6:8]
    change = v_out - v_in
    later = -float((b - a) @ change) / max(float(change @ change), 1e-9)
    place = (a + v_in * later + b + v_out * later) / 2
    return np.concatenate([[later], place, v_in, v_out])


def _side(u: np.ndarray, q: np.ndarray, noise: Noise) -> tuple[np.ndarray, np.ndarray]:
    """Place and velocity (4,) at u = 0 of the frames (n,), (n, 2), and their covariance (4, 4)."""
    speed = float(np.linalg.norm(q[-1] - q[0])) / max(float(np.ptp(u)), 1e-6)
    sigma = float(noise.std(speed))
    basis = np.stack([np.ones_like(u), u, u * u / 2], axis=1)
    inverse = np.linalg.inv(basis.T @ basis + np.diag([0.0, 0.0, (sigma / BRAKING) ** 2]))
    fit = inverse @ basis.T @ q
    covariance = np.kron(inverse[:2, :2], np.eye(2)) * sigma**2
    return fit[:2].ravel(), covariance
