"""The learner's reward: the variant's own reward, goals, shots, and potential-based shaping."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from agents.policy.scaling import SPEED_SCALE
from puckpilot_env.kernel import kernel
from puckpilot_env.tables import Tables

DIRECTIONS = (1.0, -1.0)  # sign of x in which player 0 and player 1 attack
FASTEST_SHOT = 2.0  # in units of SPEED_SCALE; a faster shot earns no more


class StepStart(NamedTuple):
    """What the reward of a step needs to know of the tables before it.

    - `potential` (n, 2): each player's shaping potential.
    - `in_far_half` (n,): whether the puck is in the half of player 1.
    """

    potential: NDArray[np.float64]
    in_far_half: NDArray[np.bool_]


@dataclass(frozen=True)
class Rewards:
    """Weights of a learner's reward: the variant's own reward, goals, shots, and potential-based shaping.

    - `rules`: weight of the variant's reward. That is no zero-sum reward: it pays for fast shots more than for goals.
    - `goal`: for a goal scored; a goal conceded costs as much.
    - `shot`: times (v / 5 m/s)^2, where v is the puck's speed towards the other goal as it crosses the middle line;
      the opponent loses as much. Without it players learn to keep goals out, and then no longer attack.

    Shaping adds `gamma` times the potential after a step minus the potential before it. This leaves optimal play
    unchanged (Ng, Harada, Russell, "Policy invariance under reward transformations", ICML 1999). The potential is the
    sum of the three parts below. It is 0 after an episode has ended. A step that truncates an episode has no shaping.

    - `place`: times how far the puck is up the table, -1 to 1.
    - `speed`: times the puck's speed up the table, in units of 5 m/s, cut to -1 to 1.
    - `chase`: minus the mallet's distance, in table lengths, from where it touches the puck from behind; only for the
      player in whose half the puck is.
    """

    rules: float = 1.0
    goal: float = 0.0
    shot: float = 0.0
    place: float = 0.0
    speed: float = 0.0
    chase: float = 0.0

    def measure(self, tables: Tables) -> StepStart:
        """Measure the tables; call it before a step and pass the result to `of_step`."""
        start = StepStart(np.empty((len(tables), 2)), np.empty(len(tables), np.bool_))
        weights = (float(self.place), float(self.speed), float(self.chase))
        _measure(tables.states, tables.params, weights, start.potential, start.in_far_half)
        return start

    def of_step(
        self, tables: Tables, before: StepStart, scored: NDArray[np.int64], done: NDArray[np.bool_], gamma: float
    ) -> NDArray[np.float32]:
        """(n, 2) rewards of both players for the step just played.

        `before`: what `measure` gave before the step; `scored` (n, 2): goals of each player in it; `done` (n,): tables
        on which an episode ended; `gamma`: discount factor a step.
        """
        after = self.measure(tables)
        goals = self.goal * (scored - scored[:, ::-1])
        puck_was_placed = done | scored.any(axis=1)
        extra = np.empty((len(tables), 2))
        _shaping_and_shots(
            tables.states, before, after, puck_was_placed, done, tables.truncated, gamma, self.shot, extra
        )
        return (self.rules * tables.rewards + goals + extra).astype(np.float32)


@kernel
def _measure(states, params, weights, potential, in_far_half):
    """Write both players' `potential` (n, 2) and which pucks are `in_far_half` (n,)."""
    place, speed, chase = weights
    for i in range(states.shape[0]):
        puck, p = states[i].puck, params[i]
        in_far_half[i] = puck.x > 0.5 * p.length
        up_the_table = place * (2.0 * puck.x / p.length - 1.0) + speed * _clipped(puck.vx / SPEED_SCALE, 1.0)
        potential[i, 0], potential[i, 1] = up_the_table, -up_the_table
        owner = 1 if in_far_half[i] else 0
        distance = _distance_from_behind(puck, states[i].mallets[owner], p, DIRECTIONS[owner])
        potential[i, owner] -= chase * distance / p.length


@kernel
def _distance_from_behind(puck, mallet, p, direction):
    """Distance [m] of the mallet from where it just touches the puck from behind."""
    behind = puck.x - direction * (p.puck_radius + p.mallet_radius)
    x = mallet.x.rest + mallet.x.slow + mallet.x.fast
    y = mallet.y.rest + mallet.y.slow + mallet.y.fast
    return math.hypot(behind - x, puck.y - y)


@kernel
def _clipped(value, most):
    return min(max(value, -most), most)


@kernel
def _shaping_and_shots(states, before, after, puck_was_placed, done, truncated, gamma, shot, extra):
    """Write the shaping and the reward of shots over the middle line into `extra` (n, 2)."""
    for i in range(states.shape[0]):
        speed = _clipped(states[i].puck.vx / SPEED_SCALE, FASTEST_SHOT)
        crossed = int(after.in_far_half[i]) - int(before.in_far_half[i])
        reward = shot * crossed * speed * speed if crossed * speed > 0.0 and not puck_was_placed[i] else 0.0
        for player in range(2):
            later = 0.0 if done[i] else gamma * after.potential[i, player]
            shaping = 0.0 if truncated[i] else later - before.potential[i, player]  # the end's potential is unknown
            extra[i, player] = DIRECTIONS[player] * reward + shaping
