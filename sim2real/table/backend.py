"""What a table is to the player of the robot's seat: frames and telemetry come from it, trajectories go to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sim2real.table.mallet_driver import MalletPlan

Place = tuple[float, float]  # m, in the table's frame


class TableFaultError(ValueError):
    """The table stopped, or cannot be used. The text is one line that says why and what to do."""


@dataclass(frozen=True)
class SeenFrame:
    """What the camera measured in one frame: `time` of its exposure on the host's clock [s]; places, None if unseen."""

    time: float
    puck: Place | None
    opponent: Place | None


@dataclass(frozen=True)
class Reading:
    """All that came since the last reading.

    `frames`: in order of time; `late_s`: age of the newest frame now [s], nan without frames; `off_path`: the farthest
    that the encoders had the mallet from its path [m].
    """

    frames: list[SeenFrame]
    late_s: float
    off_path: float


class Backend(Protocol):
    """A table. It is not connected when it is made; every way out ends in `close`, which stops the mallet first."""

    def seed(self, seed: int) -> None:
        """Begin the randomness of all that is drawn anew; before `connect`."""
        ...

    def connect(self, home: Place) -> None:
        """Connect, home the mallet at `home` [m] and arm the motors. TableFaultError, in one line, if that fails."""
        ...

    def now(self) -> float:
        """The host's time [s]."""
        ...

    def wait(self, until: float) -> None:
        """Serve the line until the host's time `until` [s]."""
        ...

    def read(self) -> Reading:
        """What came since the last call. TableFaultError, in one line, if the board stopped the motors, or refused."""
        ...

    def send(self, plan: MalletPlan) -> None:
        """Send a plan, which acts at its `begin`. TableFaultError if it cannot be sent."""
        ...

    def place_puck(self, puck: np.ndarray) -> None:
        """Have the puck put at (x, y, vx, vy) [m, m/s] by whoever stands at the table."""
        ...

    def show(self, game: np.void) -> None:
        """Show the state of the game, a `state.TABLE` record, to the opponent, who plays on by it."""
        ...

    def close(self) -> None:
        """Switch the motors off, whatever the state, and free all that was opened; may be called again."""
        ...
