"""The load that a decision puts on the gantry: the mallet's peak acceleration until the next decision."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from puckpilot_env.game import mirror
from puckpilot_env.game.state import TABLE
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.gantry.mallet import motion_at
from puckpilot_env.physics.gantry.plan import plan_mallet
from puckpilot_env.tables import Tables

SAMPLES = 24  # of the velocity between two decisions


def peak_accelerations(tables: Tables, actions: NDArray[np.float32]) -> NDArray[np.float64]:
    """(n,) peak acceleration [m/s^2] of player 0's mallet on each table if `actions` (n, 2, 4) were played now.

    It is the largest mean acceleration over SAMPLES equal parts of the time between two decisions.
    """
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
        for k in range(1, SAMPLES + 1):
            _, _, ux, uy = motion_at(mallet, k * period / SAMPLES)
            peak = max(peak, math.hypot(ux - vx, uy - vy))
            vx, vy = ux, uy
        peaks[i] = peak * SAMPLES / period
