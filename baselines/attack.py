"""Players that wait in front of the goal, block what comes, and strike when they can: the shared decision.

What differs between them is `ways`: where they aim.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from baselines.aim import first_strike
from baselines.geometry import crossing, fill_mallet, guard_place, volts_to_pass
from baselines.player import Player
from baselines.sight import Seen
from puckpilot_env.kernel import array_kernel, kernel
from puckpilot_env.physics.mallet import MALLET

GUARD = 0.2  # m from the goal line to where it waits
LATEST_STRIKE, LATEST_CROSSING = 0.5, 1.5  # s


class Attacker(Player):
    """Strikes along the first of `ways` that it can: rows of way (see `aim`) and share of half the goal's width."""

    ways: tuple[tuple[int, float], ...] = ()

    def decide(self, seen: Seen) -> NDArray[np.float64]:
        """See `Player.decide`."""
        actions = np.zeros((len(seen.puck), 4))
        ways = np.array(self.ways, np.float64)
        bounds = self.seat.action_bounds.astype(np.float64)
        _decide(seen.puck, seen.mallet, seen.gantry_scale, self.seat.nominal, bounds, ways, actions)
        return actions


@array_kernel
def _decide(pucks, mallets, scales, nominal, bounds, ways, actions):
    """Write every table's action into `actions` (n, 4)."""
    p = nominal[0]
    mallet = np.zeros(1, MALLET)[0]
    for i in range(pucks.shape[0]):
        fill_mallet(mallet, p, scales[i], mallets[i])
        if not strike_or_nothing(pucks[i], mallets[i], p, mallet, bounds, ways, actions[i]):
            block(pucks[i], mallets[i], p, mallet, bounds, actions[i])


@array_kernel
def strike_or_nothing(puck, own, p, mallet, bounds, ways, out):
    """Write the soonest strike along any of `ways` into `out` (4,); False if there is none."""
    best = math.inf
    other = np.zeros(4)
    room = 0.5 * p.goal_width - p.puck_radius
    for w in range(ways.shape[0]):
        goal_y = 0.5 * p.width + ways[w, 1] * room
        t = first_strike(puck, own, p, mallet, bounds, int(ways[w, 0]), goal_y, 0.0, LATEST_STRIKE, other)
        if t < best:
            best = t
            out[:] = other
    return best < math.inf


@kernel
def block(puck, own, p, mallet, bounds, out):
    """Write into `out` (4,) where to stand: in the way of a puck that comes, or before the goal; behind the puck."""
    out[2], out[3] = bounds[1, 2], bounds[1, 3]
    reach = p.puck_radius + p.mallet_radius
    x, y, vx, vy = puck[0], puck[1], puck[2], puck[3]
    out[0], out[1] = guard_place(x, y, p, GUARD)
    t, at_y = crossing(x, y, vx, vy, p, GUARD, LATEST_CROSSING)
    if t < math.inf:
        out[1] = at_y
        late = abs(volts_to_pass(mallet.y, at_y - own[1], own[3], t)) > bounds[1, 3]
        if late:  # meet it nearer to the goal
            out[0] = bounds[0, 0]
            out[1] = crossing(x, y, vx, vy, p, bounds[0, 0], LATEST_CROSSING)[1]
    elif x < own[0] + reach and x < 0.5 * p.length:  # the puck is behind: go back on the goal's side of it
        out[0] = bounds[0, 0]
        towards_middle = 1.0 if y < 0.5 * p.width else -1.0
        if abs(own[1] - y) < 1.5 * reach and own[0] > x:
            out[1] = y + 2.0 * reach * towards_middle
        else:
            out[1] = y + 0.5 * reach * towards_middle
    elif x < 0.5 * p.length:  # nothing threatens: line up behind it
        out[0], out[1] = max(x - 3.0 * reach, bounds[0, 0]), y
