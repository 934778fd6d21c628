"""Stays in front of its goal and follows the puck from post to post; it ignores the side walls."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baselines.observation_decoder import DecodedState
from baselines.player import Player

VOLTS = 4.0  # V, far below the limit, for smooth motion
SLOWEST_SHOT = 0.3  # m/s towards the goal; for a slower puck its position alone counts


class Goalie(Player):
    """Waits two mallet radii in front of the goal line, where a straight shot would cross."""

    def decide(self, state: DecodedState) -> NDArray[np.float64]:
        """See `Player.decide`."""
        p = self.seat.parameters
        x = 2.0 * p["mallet_radius"]
        puck_x, puck_y, puck_vx, puck_vy = state.puck.T
        coming = puck_vx < -SLOWEST_SHOT
        ahead = np.where(coming, (puck_x - x) / np.where(coming, -puck_vx, 1.0), 0.0)
        straight = puck_y + puck_vy * ahead
        y = np.where(coming & (straight > 0.0) & (straight < p["width"]), straight, puck_y)
        half, middle = 0.5 * p["goal_width"], 0.5 * p["width"]
        return self.action(x, np.clip(y, middle - half, middle + half), VOLTS)
