"""Stays where it is: what any player has to beat."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baselines.player import Player
from baselines.sight import Seen


class Still(Player):
    """Asks for its own place with the least voltage."""

    def decide(self, seen: Seen) -> NDArray[np.float64]:
        """See `Player.decide`."""
        return self.action(seen.mallet[:, 0], seen.mallet[:, 1], volts=0.0)
