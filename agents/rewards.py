"""What a learner is rewarded with: the variant's own reward, goals, shots, and the way of the puck."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from agents.scaling import SPEED_SCALE
from puckpilot_env.tables import Tables

SIDES = np.array([1.0, -1.0])  # a player 0's x direction, and player 1's
FASTEST_SHOT = 2.0  # in units of SPEED_SCALE; faster ones are worth no more


@dataclass(frozen=True)
class Before:
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
        return Before(self._potential(tables), _beyond(tables))

    def after(
        self, tables: Tables, before: Before, scored: NDArray[np.int64], done: NDArray[np.bool_], gamma: float
    ) -> NDArray[np.float32]:
        """(n, 2) of a step in which each player `scored` (n, 2) goals, and on tables `done` (n,) an episode ended."""
        shaping = gamma * np.where(done[:, None], 0.0, self._potential(tables)) - before.potential
        shaping[tables.truncated] = 0.0  # where it was cut is known to no one any more
        goals = self.goal * (scored - scored[:, ::-1])
        moved_on = done | (scored.sum(axis=1) > 0)  # the puck was put elsewhere
        crossed = np.where(moved_on, 0, _beyond(tables).astype(int) - before.beyond)
        pace = np.clip(tables.states["puck"]["vx"] / SPEED_SCALE, -FASTEST_SHOT, FASTEST_SHOT)
        shots = self.shot * (np.where(crossed * pace > 0.0, crossed * pace**2, 0.0))[:, None] * SIDES
        return (self.rules * tables.rewards + goals + shots + shaping).astype(np.float32)

    def _potential(self, tables: Tables) -> NDArray[np.float64]:
        puck, length = tables.states["puck"], tables.params["length"]
        ahead = self.place * (2.0 * puck["x"] / length - 1.0)
        ahead += self.speed * np.clip(puck["vx"] / SPEED_SCALE, -1.0, 1.0)
        return ahead[:, None] * SIDES - self.chase * _ways(tables) / length[:, None]


def _beyond(tables: Tables) -> NDArray[np.bool_]:
    return tables.states["puck"]["x"] > 0.5 * tables.params["length"]


def _ways(tables: Tables) -> NDArray[np.float64]:
    """(n, 2) from each mallet to where it just touches the puck from behind [m]; 0 where the puck is not its."""
    puck, mallets, p = tables.states["puck"], tables.states["mallets"], tables.params
    reach = (p["puck_radius"] + p["mallet_radius"])[:, None]
    x, y = (mallets[axis]["rest"] + mallets[axis]["slow"] + mallets[axis]["fast"] for axis in "xy")
    ways = np.hypot(puck["x"][:, None] - SIDES * reach - x, puck["y"][:, None] - y)
    return np.where(_beyond(tables)[:, None] == (SIDES < 0), ways, 0.0)
