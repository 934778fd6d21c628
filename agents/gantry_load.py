"""What a decision asks of the gantry until the next one: the greatest acceleration of its mallet on the way."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from puckpilot_env.game import mirror
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.mallet import motion_at
from puckpilot_env.physics.plan import plan_mallet
from puckpilot_env.state import TABLE
from puckpilot_env.tables import Tables

MOMENTS = 24  # between two decisions, at which the velocity is looked at


def peak_accelerations(tables: Tables, actions: NDArray[np.float32]) -> NDArray[np.float64]:
    """(n,) [m/s^2] of player 0's mallet on each of `tables`, were `actions` (n, 2, 4) played now."""
    peaks = np.empty(len(tables))
    _peaks(tables.states, tables.params, actions, tables.variant.period, np.zeros(1, TABLE), peaks)
    return peaks


@kernel
def _peaks(states, params, actions, period, scratch, peaks):
    for i in range(states.size):
        scratch[0] = states[i]
        mallet, p = scratch[0].mallets[0], params[i]
        wanted = actions[i, 0]
        plan_mallet(mallet, wanted[0], wanted[1], wanted[2], wanted[3], mirror.area(0, p), p.max_voltage)
        _, _, vx, vy = motion_at(mallet, 0.0)
        peak = 0.0
        for k in range(1, MOMENTS + 1):
            _, _, ux, uy = motion_at(mallet, k * period / MOMENTS)
            peak = max(peak, math.hypot(ux - vx, uy - vy))
            vx, vy = ux, uy
        peaks[i] = peak * MOMENTS / period
