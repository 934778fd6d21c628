"""What a learner is rewarded with: the variant's own reward, goals, and getting the puck to where goals are scored."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from agents.scaling import SPEED_SCALE
from puckpilot_env.tables import Tables

SIDES = np.array([1.0, -1.0])  # a player 0's x direction, and player 1's


@dataclass(frozen=True)
class Rewards:
    """`rules` times the variant's reward, `goal` for a goal scored, less `conceded` for one against, plus shaping.

    The variant's reward is not a zero-sum one: it pays for fast shots more than for goals. Who trains for winning adds
    goals; who wants attacks makes a goal worth more than what it costs. Shaping adds `gamma` times the potential after a step, less the potential before it, which changes no optimal
    play (Ng, Harada, Russell, ICML 1999); the potential is `place` times how far the puck is up the table, from -1 to
    1, plus `speed` times how fast it flies there, in units of 5 m/s, less `chase` times how far the mallet is from
    right behind a puck in the own half, in table lengths. It is 0 where an episode has ended.
    """

    rules: float = 1.0
    goal: float = 0.0
    conceded: float = 0.0
    place: float = 0.0
    speed: float = 0.0
    chase: float = 0.0

    def potential(self, tables: Tables) -> NDArray[np.float64]:
        """(n, 2) of each player, now."""
        puck, length = tables.states["puck"], tables.params["length"]
        ahead = self.place * (2.0 * puck["x"] / length - 1.0)
        ahead += self.speed * np.clip(puck["vx"] / SPEED_SCALE, -1.0, 1.0)
        return ahead[:, None] * SIDES - self.chase * _ways(tables) / length[:, None]

    def of(
        self, rewards: NDArray[np.float32], scored: NDArray[np.int64], shaping: NDArray[np.float64]
    ) -> NDArray[np.float32]:
        """(n, 2) of the variant's rewards, of each player's goals in the step, and of the gain in potential."""
        goals = self.goal * scored - self.conceded * scored[:, ::-1]
        return (self.rules * rewards + goals + shaping).astype(np.float32)


def _ways(tables: Tables) -> NDArray[np.float64]:
    """(n, 2) from each mallet to where it just touches the puck from behind [m]; 0 where the puck is not its."""
    puck, mallets, p = tables.states["puck"], tables.states["mallets"], tables.params
    reach = (p["puck_radius"] + p["mallet_radius"])[:, None]
    x, y = (mallets[axis]["rest"] + mallets[axis]["slow"] + mallets[axis]["fast"] for axis in "xy")
    ways = np.hypot(puck["x"][:, None] - SIDES * reach - x, puck["y"][:, None] - y)
    return np.where((puck["x"] < 0.5 * p["length"])[:, None] == (SIDES > 0), ways, 0.0)
