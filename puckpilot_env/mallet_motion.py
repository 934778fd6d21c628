"""Places and velocities of mallets from a batch of states, for those who look at tables from outside the kernels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from puckpilot_env.physics.mallet import FAST, FAST_RATE, SLOW, SLOW_RATE


def motion_of_mallets(states: NDArray[np.void]) -> NDArray[np.float64]:
    """`(n, 2, 4)`: x, y, vx, vy [m, m/s] of both mallets in the table's frame."""
    modes, gantry = states["modes"], states["gantry"]
    places = modes.sum(-1)
    speeds = -gantry[..., SLOW_RATE] * modes[..., SLOW] - gantry[..., FAST_RATE] * modes[..., FAST]
    return np.concatenate([places, speeds], axis=-1)
