"""Strikes like the interceptor, but at the post from which the opponent's mallet is farther.

No player of this project was trained against it: the benchmark keeps it to see whether what was learnt holds against
somebody new.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baselines.observation_decoder import DecodedState
from baselines.planning.aim import DIRECT
from baselines.planning.attack import Attacker

CORNER = 0.8  # of the room that the puck has beside the goal's middle


class CornerShot(Attacker):
    """Aims past the opponent."""

    def decide(self, state: DecodedState) -> NDArray[np.float64]:
        """See `Player.decide`."""
        at_right_post, at_left_post = (self.plan(state, ((DIRECT, side * CORNER),)) for side in (-1.0, 1.0))
        opponent_left = state.opponent[:, 1] > 0.5 * self.seat.parameters["width"]
        return np.where(opponent_left[:, None], at_right_post, at_left_post)
