"""The basis library of the glides: nonparametric forces on the puck, candidates where no listed effect fits.

Each family is a set of accelerations (n, 2, k) [m/s^2] along a motion; its coefficients are of order 1.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from puckpilot_env.physics.effects.unlisted_force import HARMONICS, TIME_KNOTS, WAVES_X, WAVES_Y
from sim2real.diagnose.regimes.sliding.tuned import SLIDING
from sim2real.statistics.piecewise import after_contact_hats, cosine_basis, expected_size, hats, spline_basis

PERIODS = SLIDING.wave_span / np.arange(*map(float, SLIDING.wave_numbers))  # s, of a single wave in time
SPIN = "side force by each launch's spin"


@dataclass(frozen=True)
class Motion:
    """The quantities that forces may depend on.

    `t` (n,) [s]; `place` (n, 2) [m]; `velocity` (n, 2) [m/s]; `since` (n,) [s]: time since the last contact, nan if
    unknown; `launch` (n,): number of the launch; `age` (n,) [s]: time since its start; `size` (2,) [m] of the table;
    `speeds` (k,) [m/s]: the knots of forces by speed, which are piecewise linear.
    """

    t: np.ndarray
    place: np.ndarray
    velocity: np.ndarray
    since: np.ndarray
    launch: np.ndarray
    age: np.ndarray
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


def cosine_sizes() -> np.ndarray:
    """Expected sizes (WAVES_X WAVES_Y,) of `cosines`."""
    return expected_size(np.hypot(*np.meshgrid(np.arange(WAVES_X), np.arange(WAVES_Y), indexing="ij"))).ravel()


def ripple_sizes(axis: int) -> np.ndarray:
    """Expected sizes (SLIDING.ripples[axis],) of the cosines along one axis."""
    return expected_size(np.arange(SLIDING.ripples[axis]))


def cosines(motion: Motion) -> np.ndarray:
    """Products (n, WAVES_X WAVES_Y) of cosines of x and y."""
    u, w = (motion.place / motion.size).T
    x = np.stack([np.cos(np.pi * i * u) for i in range(WAVES_X)])
    y = np.stack([np.cos(np.pi * j * w) for j in range(WAVES_Y)])
    return (x[:, None] * y[None]).reshape(-1, len(u)).T * cosine_sizes()


def _ripples(motion: Motion, axis: int) -> np.ndarray:
    """Cosines (n, SLIDING.ripples[axis]) of the place along one axis of the table."""
    return cosine_basis(motion.place[:, axis] / motion.size[axis], SLIDING.ripples[axis])


def harmonics(motion: Motion) -> np.ndarray:
    """Cosines and sines (n, 2 HARMONICS) of multiples of the heading, alternating."""
    angle = np.arctan2(motion.velocity[:, 1], motion.velocity[:, 0])
    return np.stack([f(k * angle) for k in range(1, HARMONICS + 1) for f in (np.cos, np.sin)], axis=1)


def _along(weights: np.ndarray, *vectors: np.ndarray) -> np.ndarray:
    """Accelerations (n, 2, …) [m/s^2]: each weight (n, k) times each vector (n, 2)."""
    return SLIDING.unit * np.concatenate([weights[:, None, :] * vector[:, :, None] for vector in vectors], axis=2)


def _axes(motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors (n, 2) along x and along y."""
    n = len(motion.t)
    return np.tile([1.0, 0.0], (n, 1)), np.tile([0.0, 1.0], (n, 1))


def time_knots(motion: Motion) -> np.ndarray:
    """The knots (k,) [s] of forces by time, which are piecewise linear."""
    return np.linspace(motion.t.min(), motion.t.max(), TIME_KNOTS)


def _speeds(motion: Motion) -> np.ndarray:
    """Basis functions (n, k) of the speed."""
    return hats(np.linalg.norm(motion.velocity, axis=1), motion.speeds) @ spline_basis(motion.speeds)


def _moments(motion: Motion) -> np.ndarray:
    """Basis functions (n, k) of the time."""
    knots = time_knots(motion)
    return hats(motion.t, knots) @ spline_basis(knots)


def _histories(motion: Motion) -> np.ndarray:
    """Basis functions (n, k) of the time since the last contact."""
    return after_contact_hats(motion.since, SLIDING.history_knots)


def _spins(motion: Motion) -> np.ndarray:
    """Speed times the remaining share of the launch's spin (n, launches) [m/s], one column for each launch."""
    speed = np.linalg.norm(motion.velocity, axis=1) * np.exp(-SLIDING.spin_decay * motion.age)
    return speed[:, None] * (motion.launch[:, None] == np.arange(motion.launch.max(initial=0.0) + 1.0))


def _waving(period: float, motion: Motion) -> np.ndarray:
    """Decelerations (n, 2, 2) [m/s^2] proportional to a sine and a cosine of the time."""
    turns = 2.0 * np.pi * motion.t / period
    return _along(np.stack([np.sin(turns), np.cos(turns)], axis=1), -motion.along)


WAVES = {f"brake by a wave of {period:.4g} s": period for period in PERIODS}
Family = Callable[[Motion], np.ndarray]
FAMILIES: dict[str, tuple[str, Family]] = {
    "push by position": ("position", lambda m: _along(cosines(m), *_axes(m))),
    "brake by position": ("position", lambda m: _along(cosines(m), -m.along)),
    "push by place along the table": ("position", lambda m: _along(_ripples(m, 0), *_axes(m))),
    "push by place across the table": ("position", lambda m: _along(_ripples(m, 1), *_axes(m))),
    "brake by place along the table": ("position", lambda m: _along(_ripples(m, 0), -m.along)),
    "brake by place across the table": ("position", lambda m: _along(_ripples(m, 1), -m.along)),
    "brake by speed": ("speed", lambda m: _along(_speeds(m), -m.along)),
    "side force by speed": ("speed", lambda m: _along(_speeds(m), m.across)),
    "force by heading": ("heading", lambda m: _along(harmonics(m), -m.along, m.across)),
    "push by time": ("time", lambda m: _along(_moments(m), *_axes(m))),
    "brake by time": ("time", lambda m: _along(_moments(m), -m.along)),
    "brake after a contact": ("history", lambda m: _along(_histories(m), -m.along)),
    SPIN: ("history", lambda m: _along(_spins(m), m.across)),
    "side force after a contact": ("history", lambda m: _along(_histories(m), m.across)),
    **{name: ("time", partial(_waving, period)) for name, period in WAVES.items()},
}


def force(name: str, motion: Motion, theta: np.ndarray) -> np.ndarray:
    """Accelerations (n, 2) [m/s^2] of a family with coefficients `theta`."""
    return FAMILIES[name][1](motion) @ theta
