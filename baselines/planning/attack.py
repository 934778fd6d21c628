"""The decision shared by players that guard the goal, block incoming pucks, and strike when they can.

They differ in `shots`, where they aim.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baselines.observation_decoder import DecodedState
from baselines.planning.aim import first_strike
from baselines.planning.geometry import crossing, fill_mallet, guard_place, volts_to_pass
from baselines.player import Player
from puckpilot_env.kernel import array_kernel, kernel
from puckpilot_env.physics.gantry.mallet import MALLET

GUARD = 0.2  # m from the goal line to where it waits
LATEST_STRIKE, LATEST_CROSSING = 0.5, 1.5  # s


class Attacker(Player):
    """Plays the earliest possible strike of `shots`: pairs of a path (see `aim`) and a point in the goal.

    The point is a share, -1 to 1, of the room that the puck has to either side of the goal's middle.
    """

    shots: tuple[tuple[int, float], ...] = ()

    def decide(self, state: DecodedState) -> NDArray[np.float64]:
        """See `Player.decide`."""
        return self.plan(state, self.shots)

    def plan(self, state: DecodedState, shots: Sequence[tuple[int, float]]) -> NDArray[np.float64]:
        """Actions (n, 4): the earliest strike of any of these shots, or a block."""
        actions = np.zeros((len(state.puck), 4))
        bounds = self.seat.action_bounds.astype(np.float64)
        mallets = np.zeros(1, MALLET)
        _decide(
            state.puck, state.mallet, state.gantry_scale, self.seat.nominal, bounds, np.array(shots), mallets, actions
        )
        return actions


@array_kernel
def _decide(pucks, owns, scales, nominal, bounds, shots, mallets, actions):
    """Write every table's action into `actions` (n, 4). `mallets`: one record, to compute with."""
    p, mallet = nominal[0], mallets[0]
    for i in range(pucks.shape[0]):
        fill_mallet(mallet, p, scales[i], owns[i])
        if not strike_or_nothing(pucks[i], owns[i], p, mallet, bounds, shots, actions[i]):
            block(pucks[i], owns[i], p, mallet, bounds, actions[i])


@array_kernel
def strike_or_nothing(puck, own, p, mallet, bounds, shots, out):
    """Write the earliest strike of any of `shots` into `out` (4,); False if there is none."""
    best = math.inf
    other = np.zeros(4)
    room = 0.5 * p.goal_width - p.puck_radius
    for w in range(shots.shape[0]):
        goal_y = 0.5 * p.width + shots[w, 1] * room
        t = first_strike(puck, own, p, mallet, bounds, int(shots[w, 0]), goal_y, 0.0, LATEST_STRIKE, other)
        if t < best:
            best = t
            out[:] = other
    return best < math.inf


@kernel
def block(puck, own, p, mallet, bounds, out):
    """Write a defensive action into `out` (4,).

    It goes into the path of an incoming puck, back to the goal side of a puck that has passed, or in front of the goal.
    """
    out[2], out[3] = bounds[1, 2], bounds[1, 3]
    reach = p.puck_radius + p.mallet_radius
    x, y, vx, vy = puck[0], puck[1], puck[2], puck[3]
    out[0], out[1] = guard_place(x, y, p, GUARD)
    t, at_y = crossing(x, y, vx, vy, p, GUARD, LATEST_CROSSING)
    if t < math.inf:
        out[1] = at_y
        late = abs(volts_to_pass(mallet.y, at_y - own[1], own[3], t)) > bounds[1, 3]
        if late:  # too late there: block nearer to the goal
            out[0] = bounds[0, 0]
            out[1] = crossing(x, y, vx, vy, p, bounds[0, 0], LATEST_CROSSING)[1]
    elif x < own[0] + reach and x < 0.5 * p.length:  # the puck is behind the mallet: go back to its goal side
        out[0] = bounds[0, 0]
        towards_middle = 1.0 if y < 0.5 * p.width else -1.0
        if abs(own[1] - y) < 1.5 * reach and own[0] > x:
            out[1] = y + 2.0 * reach * towards_middle
        else:
            out[1] = y + 0.5 * reach * towards_middle
    elif x < 0.5 * p.length:  # no threat: line up behind the puck
        out[0], out[1] = max(x - 3.0 * reach, bounds[0, 0]), y
