"""The basis library of the glides: nonparametric forces on the puck, candidates where no listed effect fits.

Each family is a set of accelerations (n, 2, k) [m/s^2] along a motion; its coefficients are of order 1.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from puckpilot_env.physics.effects.unlisted_force import HARMONICS, TIME_KNOTS, WAVES_X, WAVES_Y
from sim2real.diagnose.regimes.sliding.forces.motion import Motion, along_axes, scaled
from sim2real.diagnose.regimes.sliding.forces.searched_forces import searched_force
from sim2real.diagnose.regimes.sliding.tuned import SLIDING
from sim2real.statistics.piecewise import after_contact_hats, cosine_basis, expected_size, hats, spline_basis

SPIN = "side force by each launch's spin"


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


Family = Callable[[Motion], np.ndarray]
FAMILIES: dict[str, tuple[str, Family]] = {
    "push by position": ("position", lambda m: scaled(cosines(m), *along_axes(m))),
    "brake by position": ("position", lambda m: scaled(cosines(m), -m.along)),
    "push by place along the table": ("position", lambda m: scaled(_ripples(m, 0), *along_axes(m))),
    "push by place across the table": ("position", lambda m: scaled(_ripples(m, 1), *along_axes(m))),
    "brake by place along the table": ("position", lambda m: scaled(_ripples(m, 0), -m.along)),
    "brake by place across the table": ("position", lambda m: scaled(_ripples(m, 1), -m.along)),
    "brake by speed": ("speed", lambda m: scaled(_speeds(m), -m.along)),
    "side force by speed": ("speed", lambda m: scaled(_speeds(m), m.across)),
    "force by heading": ("heading", lambda m: scaled(harmonics(m), -m.along, m.across)),
    "push by time": ("time", lambda m: scaled(_moments(m), *along_axes(m))),
    "brake by time": ("time", lambda m: scaled(_moments(m), -m.along)),
    "brake after a contact": ("history", lambda m: scaled(_histories(m), -m.along)),
    SPIN: ("history", lambda m: scaled(_spins(m), m.across)),
    "side force after a contact": ("history", lambda m: scaled(_histories(m), m.across)),
}


def basis_of(name: str) -> Family:
    """The accelerations of a family, or of a searched force, by its name."""
    searched = searched_force(name)
    return searched.force if searched else FAMILIES[name][1]


def force(name: str, motion: Motion, theta: np.ndarray) -> np.ndarray:
    """Accelerations (n, 2) [m/s^2] of a family with coefficients `theta`."""
    return basis_of(name)(motion) @ theta
