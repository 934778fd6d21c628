"""Adds positions, velocities and predictions to observations that hold nothing but camera frames.

Most policies are trained at variants whose observations have columns for the puck's velocity and for where the puck is
expected. A variant that gives raw camera frames alone lacks these. The observation decoder of the scripted players
(`baselines.observation_decoder`) estimates positions and velocities from the frames. The simulator's own prediction
with nominal parameters gives the expected positions. So one network plays both kinds of variants.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baselines.observation_decoder import MOTION, ObservationDecoder
from baselines.player import Seat
from puckpilot_env.game.observation import HORIZONS
from puckpilot_env.game.predict import expected_place
from puckpilot_env.kernel import kernel

DECODED_COLUMNS = (
    *(f"{what}{suffix}" for what in ("puck", "opponent") for suffix in MOTION),
    *(f"expected_{horizon:g}s_{axis}" for horizon in HORIZONS for axis in "xy"),
)


class FrameDecoder:
    """Appends DECODED_COLUMNS to the observations of a seat; `columns` names all columns after that, in order."""

    def __init__(self, seat: Seat) -> None:
        self._decoder = ObservationDecoder(seat.columns, seat.nominal)
        self._nominal = seat.nominal
        self.columns = [*seat.columns, *DECODED_COLUMNS]

    @staticmethod
    def is_needed(input_columns: Sequence[str], seat: Seat) -> bool:
        """Whether a network with these inputs needs velocities which the seat's raw frames do not give."""
        return "puck_vx" in input_columns and "puck_vx" not in seat.columns and "puck_0_x" in seat.columns

    def decode(self, observation: NDArray[np.float32]) -> NDArray[np.float32]:
        """(n, columns) float32 of observations (n, d), in the player's own frame; m and m/s."""
        state = self._decoder.decode(observation)
        expected = np.empty((len(observation), 2 * len(HORIZONS)))
        _expected_positions(state.puck, self._nominal, np.array(HORIZONS), expected)
        return np.hstack([observation, state.puck, state.opponent, expected]).astype(np.float32)


@kernel
def _expected_positions(pucks, nominal, horizons, expected):
    """Write where `pucks` (n, 4) are expected at the increasing `horizons` [s] into `expected` (n, 2 horizons)."""
    for i in range(pucks.shape[0]):
        x, y, vx, vy, now = pucks[i, 0], pucks[i, 1], pucks[i, 2], pucks[i, 3], 0.0
        for k in range(horizons.size):
            x, y, vx, vy = expected_place(x, y, vx, vy, nominal[0], horizons[k] - now)
            expected[i, 2 * k], expected[i, 2 * k + 1] = x, y
            now = horizons[k]
