"""Shows a network that was made for places and velocities what a history of camera frames says of them.

A variant that gives raw frames alone has no column for where the puck is now, how fast it flies and where it will be.
The observation decoder of the scripted players (`baselines.sight`) estimates the first two, the simulator's own
prediction with the nominal parameters the last; so one network plays both kinds of variants.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baselines.player import Seat
from baselines.sight import MOTION, Sight
from puckpilot_env.game.observation import HORIZONS
from puckpilot_env.game.predict import expected_place
from puckpilot_env.kernel import kernel

DECODED = (
    *(f"{what}{suffix}" for what in ("puck", "opponent") for suffix in MOTION),
    *(f"expected_{horizon:g}s_{axis}" for horizon in HORIZONS for axis in "xy"),
)


class Decoder:
    """Puts the columns DECODED behind those of a seat's observation; `columns` names them all, in order."""

    def __init__(self, seat: Seat) -> None:
        self._sight = Sight(seat.columns, seat.nominal)
        self._nominal = seat.nominal
        self.columns = [*seat.columns, *DECODED]

    @staticmethod
    def is_needed(wanted: Sequence[str], seat: Seat) -> bool:
        """Whether a network that reads the columns `wanted` would be blind at this seat, which shows raw frames."""
        return "puck_vx" in wanted and "puck_vx" not in seat.columns and "puck_0_x" in seat.columns

    def decode(self, observation: NDArray[np.float32]) -> NDArray[np.float32]:
        """(n, columns) float32 of observations (n, d), in the player's own frame."""
        seen = self._sight.read(observation)
        expected = np.empty((len(observation), 2 * len(HORIZONS)))
        _expect(seen.puck, self._nominal, np.array(HORIZONS), expected)
        return np.hstack([observation, seen.puck, seen.opponent, expected]).astype(np.float32)


@kernel
def _expect(pucks, nominal, horizons, expected):
    """Where pucks (n, 4) are expected at the `horizons` [s], increasing; expected: (n, 2 horizons), written."""
    for i in range(pucks.shape[0]):
        x, y, vx, vy, now = pucks[i, 0], pucks[i, 1], pucks[i, 2], pucks[i, 3], 0.0
        for k in range(horizons.size):
            x, y, vx, vy = expected_place(x, y, vx, vy, nominal[0], horizons[k] - now)
            expected[i, 2 * k], expected[i, 2 * k + 1] = x, y
            now = horizons[k]
