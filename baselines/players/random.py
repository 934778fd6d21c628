"""Draws every action uniformly from the action space."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baselines.observation_decoder import DecodedState
from baselines.player import Player, Seat


class Random(Player):
    """The same seed gives the same actions."""

    def __init__(self, seat: Seat) -> None:
        super().__init__(seat)
        self._draws = np.random.default_rng(seat.seed)

    def decide(self, state: DecodedState) -> NDArray[np.float64]:
        """See `Player.decide`."""
        low, high = self.seat.action_bounds
        return self._draws.uniform(low, high, (len(state.puck), 4))
