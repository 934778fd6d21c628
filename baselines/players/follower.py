"""Goes at the puck wherever it is: strikes often, aims at nothing, and leaves its goal open."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baselines.observation_decoder import DecodedState
from baselines.player import Player


class Follower(Player):
    """Drives through the puck in its own half; otherwise waits level with the puck."""

    def decide(self, state: DecodedState) -> NDArray[np.float64]:
        """See `Player.decide`."""
        p = self.seat.parameters
        reach = p["mallet_radius"] + p["puck_radius"]
        puck_x, puck_y = state.puck[:, 0], state.puck[:, 1]
        behind = puck_x < state.mallet[:, 0] + reach  # then come back first, beside it
        side = np.where(puck_y < 0.5 * p["width"], 2.0 * reach, -2.0 * reach)
        x = np.where(behind, puck_x - 2.0 * reach, puck_x + reach)
        y = np.where(behind, puck_y + side, puck_y)
        mine = puck_x < 0.5 * p["length"]
        return self.action(np.where(mine, x, 0.2 * p["length"]), y)
