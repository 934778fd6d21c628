"""Goes at the puck wherever it is: strikes often, aims at nothing, and leaves its goal open."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baselines.player import Player
from baselines.sight import Seen


class Follower(Player):
    """In the own half it drives through the puck's place; otherwise it waits level with the puck."""

    def decide(self, seen: Seen) -> NDArray[np.float64]:
        """See `Player.decide`."""
        p = self.seat.parameters
        reach = p["mallet_radius"] + p["puck_radius"]
        puck_x, puck_y = seen.puck[:, 0], seen.puck[:, 1]
        behind = puck_x < seen.mallet[:, 0] + reach  # then come back first, beside it
        side = np.where(puck_y < 0.5 * p["width"], 2.0 * reach, -2.0 * reach)
        x = np.where(behind, puck_x - 2.0 * reach, puck_x + reach)
        y = np.where(behind, puck_y + side, puck_y)
        mine = puck_x < 0.5 * p["length"]
        return self.action(np.where(mine, x, 0.2 * p["length"]), y)
