"""Stays where it is: the weakest player, which every other has to beat."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baselines.observation_decoder import DecodedState
from baselines.player import Player


class Still(Player):
    """Its target is always its own position, with the lowest voltage."""

    def decide(self, state: DecodedState) -> NDArray[np.float64]:
        """See `Player.decide`."""
        return self.action(state.mallet[:, 0], state.mallet[:, 1], volts=0.0)
