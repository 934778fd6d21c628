"""What a learner is rewarded with: the variant's own reward, goals, shots, and the way of the puck."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from agents.scaling import SPEED_SCALE
from puckpilot_env.kernel import kernel
from puckpilot_env.tables import Tables

SIDES = (1.0, -1.0)  # a player 0's x direction, and player 1's
FASTEST_SHOT = 2.0  # in units of SPEED_SCALE; faster ones are worth no more


class Before(NamedTuple):
    """What a reward must know of the tables before a step: each player's `potential` (n, 2), and whether the puck was
    `beyond` the middle line (n,), in the half of player 1."""

    potential: NDArray[np.float64]
    beyond: NDArray[np.bool_]


@dataclass(frozen=True)
class Rewards:
    """`rules` times the variant's reward, `goal` for a goal scored, less as much for one against, and shaping.

    The variant's reward is not a zero-sum one: it pays for fast shots more than for goals. Who trains for winning adds
    goals, and `shot` times the square of the speed, in units of 5 m/s, with which the puck flies over the middle line
    into the other's half, who loses as much: without it players learn to keep goals out, and then that none needs to
    be shot.

    Shaping adds `gamma` times the potential after a step, less the potential before it, which changes no optimal play
    (Ng, Harada, Russell, ICML 1999). The potential is `place` times how far the puck is up the table, from -1 to 1,
    plus `speed` times how fast it flies there, less `chase` times how far the mallet is from right behind a puck in
    the own half, in table lengths. It is 0 where an episode has ended. The step in which one was cut short is left out.
    """

    rules: float = 1.0
    goal: float = 0.0
    shot: float = 0.0
    place: float = 0.0
    speed: float = 0.0
    chase: float = 0.0

    def before(self, tables: Tables) -> Before:
        """To be kept from before a step."""
        found = Before(np.empty((len(tables), 2)), np.empty(len(tables), np.bool_))
        _look(tables.states, tables.params, self._worth, found.potential, found.beyond)
        return found

    def after(
        self, tables: Tables, before: Before, scored: NDArray[np.int64], done: NDArray[np.bool_], gamma: float
    ) -> NDArray[np.float32]:
        """(n, 2) of a step in which each player `scored` (n, 2) goals, and on tables `done` (n,) an episode ended."""
        now = self.before(tables)
        goals = self.goal * (scored - scored[:, ::-1])
        moved_on = done | scored.any(axis=1)  # the puck was put elsewhere
        extra = np.empty((len(tables), 2))
        _pay(tables.states, before, now, moved_on, done, tables.truncated, gamma, self.shot, extra)
        return (self.rules * tables.rewards + goals + extra).astype(np.float32)

    @property
    def _worth(self) -> tuple[float, float, float]:
        return float(self.place), float(self.speed), float(self.chase)


@kernel
def _look(states, params, worth, potential, beyond):
    """Write both players' `potential` (n, 2), and which pucks are `beyond` the middle line (n,)."""
    place, speed, chase = worth
    for i in range(states.shape[0]):
        puck, p = states[i].puck, params[i]
        beyond[i] = puck.x > 0.5 * p.length
        ahead = place * (2.0 * puck.x / p.length - 1.0) + speed * _clipped(puck.vx / SPEED_SCALE, 1.0)
        potential[i, 0], potential[i, 1] = ahead, -ahead
        owner = 1 if beyond[i] else 0
        potential[i, owner] -= chase * _way(puck, states[i].mallets[owner], p, SIDES[owner]) / p.length


@kernel
def _way(puck, mallet, p, side):
    """From the mallet to where it just touches the puck from behind [m]."""
    behind = puck.x - side * (p.puck_radius + p.mallet_radius)
    x = mallet.x.rest + mallet.x.slow + mallet.x.fast
    y = mallet.y.rest + mallet.y.slow + mallet.y.fast
    return math.hypot(behind - x, puck.y - y)


@kernel
def _clipped(value, most):
    return min(max(value, -most), most)


@kernel
def _pay(states, before, now, moved_on, done, truncated, gamma, shot, extra):
    """Write shaping and what shots over the middle line are worth into `extra` (n, 2)."""
    for i in range(states.shape[0]):
        pace = _clipped(states[i].puck.vx / SPEED_SCALE, FASTEST_SHOT)
        crossed = int(now.beyond[i]) - int(before.beyond[i])
        worth = shot * crossed * pace * pace if crossed * pace > 0.0 and not moved_on[i] else 0.0
        for player in range(2):
            later = 0.0 if done[i] else gamma * now.potential[i, player]
            shaping = 0.0 if truncated[i] else later - before.potential[i, player]  # cut: known to no one any more
            extra[i, player] = SIDES[player] * worth + shaping
