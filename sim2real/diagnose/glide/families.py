"""Smooth forces of any shape on a gliding puck, by what they depend on: what no listed effect says, one of these may.

Each family is a set of accelerations (n, 2, k) [m/s^2] along paths (n, 4), to be weighted by coefficients of order 1.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from puckpilot_env.physics.effects.unlisted_force import HARMONICS, TIME_KNOTS, WAVES_X, WAVES_Y
from sim2real.diagnose.piecewise import hats, memory_hats, ripples, stiff, tamed

UNIT = 0.1  # m/s^2, what a coefficient of 1 stands for
RIPPLES = (14, 8)  # of cosines along one axis alone
SPEED_KNOTS, HISTORY_KNOTS = 8, 6  # of forces that depend on the speed, and on the time since a contact
SPIN_DECAY = 0.3  # 1/s, of a spin that is not seen
PERIODS = 240.0 / np.arange(6.0, 49.0)  # s, of a single wave in time: a minute hardly tells neighbours apart
SPIN = "side force by each launch's spin"


@dataclass(frozen=True)
class Motion:
    """Glides as the families see them: `t` (n,) [s], `place`, `velocity` (n, 2), `since` (n,) [s] after the last
    contact (nan where none), the number `launch` (n,) of the launch, the time `aged` (n,) [s] since it began, the
    table's `size` (2,) [m], and `speeds` (k,) [m/s] between which a force by speed is straight."""

    t: np.ndarray
    place: np.ndarray
    velocity: np.ndarray
    since: np.ndarray
    launch: np.ndarray
    aged: np.ndarray
    size: np.ndarray
    speeds: np.ndarray

    @property
    def along(self) -> np.ndarray:
        """Unit vectors (n, 2) of the motion."""
        return self.velocity / np.maximum(np.linalg.norm(self.velocity, axis=1, keepdims=True), 1e-9)

    @property
    def across(self) -> np.ndarray:
        """Unit vectors (n, 2) to the left of the motion."""
        return np.stack([-self.along[:, 1], self.along[:, 0]], axis=1)


def over_place() -> np.ndarray:
    """Sizes (WAVES_X WAVES_Y,) of `cosines`."""
    return tamed(np.hypot(*np.meshgrid(np.arange(WAVES_X), np.arange(WAVES_Y), indexing="ij"))).ravel()


def along_axis(axis: int) -> np.ndarray:
    """Sizes (RIPPLES,) of the waves along one axis."""
    return tamed(np.arange(RIPPLES[axis]))


def cosines(motion: Motion) -> np.ndarray:
    """Smooth functions (n, WAVES_X WAVES_Y) of the place on the table."""
    u, w = (motion.place / motion.size).T
    x = np.stack([np.cos(np.pi * i * u) for i in range(WAVES_X)])
    y = np.stack([np.cos(np.pi * j * w) for j in range(WAVES_Y)])
    return (x[:, None] * y[None]).reshape(-1, len(u)).T * over_place()


def _ripples(motion: Motion, axis: int) -> np.ndarray:
    """Smooth functions (n, RIPPLES) of the place along one axis of the table."""
    return ripples(motion.place[:, axis] / motion.size[axis], RIPPLES[axis])


def harmonics(motion: Motion) -> np.ndarray:
    """Sines and cosines (n, 2 HARMONICS) of multiples of the heading."""
    angle = np.arctan2(motion.velocity[:, 1], motion.velocity[:, 0])
    return np.stack([f(k * angle) for k in range(1, HARMONICS + 1) for f in (np.cos, np.sin)], axis=1)


def _times(weights: np.ndarray, *vectors: np.ndarray) -> np.ndarray:
    """Accelerations (n, 2, …): every weight (n, k) along every vector (n, 2)."""
    return UNIT * np.concatenate([weights[:, None, :] * vector[:, :, None] for vector in vectors], axis=2)


def _axes(motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    n = len(motion.t)
    return np.tile([1.0, 0.0], (n, 1)), np.tile([0.0, 1.0], (n, 1))


def time_knots(motion: Motion) -> np.ndarray:
    """Times (k,) [s] between which a force by time is straight."""
    return np.linspace(motion.t.min(), motion.t.max(), TIME_KNOTS)


def _speeds(motion: Motion) -> np.ndarray:
    return hats(np.linalg.norm(motion.velocity, axis=1), motion.speeds) @ stiff(motion.speeds)


def _moments(motion: Motion) -> np.ndarray:
    knots = time_knots(motion)
    return hats(motion.t, knots) @ stiff(knots)


def _memory(motion: Motion) -> np.ndarray:
    return memory_hats(motion.since, HISTORY_KNOTS)


def _spins(motion: Motion) -> np.ndarray:
    """Speeds (n, launches) [m/s], each launch's in a column of its own, times what is left of its spin."""
    speed = np.linalg.norm(motion.velocity, axis=1) * np.exp(-SPIN_DECAY * motion.aged)
    return speed[:, None] * (motion.launch[:, None] == np.arange(motion.launch.max(initial=0.0) + 1.0))


def _waving(period: float, motion: Motion) -> np.ndarray:
    turns = 2.0 * np.pi * motion.t / period
    return _times(np.stack([np.sin(turns), np.cos(turns)], axis=1), -motion.along)


WAVES = {f"brake by a wave of {period:.4g} s": period for period in PERIODS}
Family = Callable[[Motion], np.ndarray]
FAMILIES: dict[str, tuple[str, Family]] = {
    "push by position": ("position", lambda m: _times(cosines(m), *_axes(m))),
    "brake by position": ("position", lambda m: _times(cosines(m), -m.along)),
    "push by place along the table": ("position", lambda m: _times(_ripples(m, 0), *_axes(m))),
    "push by place across the table": ("position", lambda m: _times(_ripples(m, 1), *_axes(m))),
    "brake by place along the table": ("position", lambda m: _times(_ripples(m, 0), -m.along)),
    "brake by place across the table": ("position", lambda m: _times(_ripples(m, 1), -m.along)),
    "brake by speed": ("speed", lambda m: _times(_speeds(m), -m.along)),
    "side force by speed": ("speed", lambda m: _times(_speeds(m), m.across)),
    "force by heading": ("heading", lambda m: _times(harmonics(m), -m.along, m.across)),
    "push by time": ("time", lambda m: _times(_moments(m), *_axes(m))),
    "brake by time": ("time", lambda m: _times(_moments(m), -m.along)),
    "brake after a contact": ("history", lambda m: _times(_memory(m), -m.along)),
    SPIN: ("history", lambda m: _times(_spins(m), m.across)),
    "side force after a contact": ("history", lambda m: _times(_memory(m), m.across)),
    **{name: ("time", partial(_waving, period)) for name, period in WAVES.items()},
}


def force(name: str, motion: Motion, theta: np.ndarray) -> np.ndarray:
    """Accelerations (n, 2) [m/s^2] of a family with coefficients `theta`."""
    return FAMILIES[name][1](motion) @ theta
