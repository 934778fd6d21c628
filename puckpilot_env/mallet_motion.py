"""Places and velocities of mallets from a batch of states, for those who look at tables from outside the kernels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def motion_of_mallets(states: NDArray[np.void]) -> NDArray[np.float64]:
    """`(n, 2, 4)`: x, y, vx, vy [m, m/s] of both mallets in the table's frame."""
    axes = [states["mallets"][axis] for axis in "xy"]
    places = [a["rest"] + a["slow"] + a["fast"] for a in axes]
    speeds = [-a["slow_rate"] * a["slow"] - a["fast_rate"] * a["fast"] for a in axes]
    return np.stack(places + speeds, axis=-1)
