"""Places and velocities from a batch of states, for those who look at tables from outside the kernels."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def puck_motion(states: NDArray[Any] | np.void) -> NDArray[np.float64]:
    """`(n, 4)`: x, y, vx, vy [m, m/s] of the pucks in the table's frame; `(4,)` of a single record."""
    return np.stack([states["puck"][name] for name in ("x", "y", "vx", "vy")], axis=-1)


def mallet_motion(states: NDArray[Any] | np.void) -> NDArray[np.float64]:
    """`(n, 2, 4)`: x, y, vx, vy [m, m/s] of both mallets in the table's frame; `(2, 4)` of a single record."""
    axes = [states["mallets"][axis] for axis in "xy"]
    places = [a["rest"] + a["slow"] + a["fast"] for a in axes]
    speeds = [-a["slow_rate"] * a["slow"] - a["fast_rate"] * a["fast"] for a in axes]
    return np.stack(places + speeds, axis=-1)
