"""The motion on which forces on a gliding puck may depend, and forces along its directions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.regimes.sliding.tuned import SLIDING

Columns = Callable[[np.ndarray], np.ndarray]  # accelerations (n, 2, k) [m/s^2] to columns (2n, k) of the residuals


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


def scaled(weights: np.ndarray, *vectors: np.ndarray) -> np.ndarray:
    """Accelerations (n, 2, …) [m/s^2]: each weight (n, k) times each vector (n, 2)."""
    return SLIDING.unit * np.concatenate([weights[:, None, :] * vector[:, :, None] for vector in vectors], axis=2)


def along_axes(motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors (n, 2) along x and along y."""
    n = len(motion.t)
    return np.tile([1.0, 0.0], (n, 1)), np.tile([0.0, 1.0], (n, 1))
