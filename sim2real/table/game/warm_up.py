"""A short imagined game, after which nothing of the loop is compiled or loaded while motors are armed."""

from __future__ import annotations

import numpy as np

from puckpilot_env.game.start import HOME
from sim2real.table.backend import Backend, Place, Reading, SeenFrame, SeenMallet
from sim2real.table.game.game_record import GameRecord
from sim2real.table.game.loop import Loop
from sim2real.table.mallet_driver import MalletPlan

STEPS = 4  # decisions


class ImaginedTable(Backend):
    """A table on which the puck goes from wall to wall, seen without an error, while the mallet is where it is sent."""

    frame_rate = 120.0

    def __init__(self, p: np.void) -> None:
        self._length, self._width = float(p["length"]), float(p["width"])
        self._now, self._read = 0.0, 0

    def seed(self, seed: int) -> None:
        """Nothing is drawn."""

    def connect(self, home: Place) -> None:
        """Nothing to connect."""

    def clear(self, home: Place) -> None:
        """Nothing stops it."""

    def now(self) -> float:
        """Imagined time [s]."""
        return self._now

    def wait(self, until: float) -> None:
        """Go on to `until` [s]."""
        self._now = max(self._now, until)

    def wait_for_frame(self, until: float) -> None:
        """Go on to `until` [s]."""
        self.wait(until)

    def place(self) -> Place:
        """The mallet's home [m]."""
        return HOME * self._length, 0.5 * self._width

    def read(self) -> Reading:
        """The frames since the last call."""
        numbers = range(self._read, int(self._now * self.frame_rate) + 1)
        self._read = numbers.stop
        mallets = [SeenMallet(self._now, self.place(), self.place(), (0.0, 0.0))]
        return Reading([self._frame(number) for number in numbers], mallets, 0.0)

    def _frame(self, number: int) -> SeenFrame:
        way = (number / self.frame_rate) % 0.5
        puck = (0.45 + 0.4 * abs(way - 0.25)) * self._length, 0.5 * self._width + way * 0.5 * self._width
        return SeenFrame(number / self.frame_rate, puck, (0.9 * self._length, 0.5 * self._width))

    def send(self, plan: MalletPlan) -> MalletPlan:
        """The plan, as it is."""
        return plan

    def stop(self) -> None:
        """Nothing moves."""

    def place_puck(self, puck: np.ndarray) -> None:
        """The puck is where it is imagined."""

    def show(self, game: np.void) -> None:
        """Nobody looks."""

    def close(self) -> None:
        """Nothing is open."""


def warm_up(game: GameRecord) -> None:
    """Play a few steps of an imagined game of the same variant and parameters; the game itself is not touched."""
    own = GameRecord(game.tables.variant, game.given, period=float(game.rule["period"]))
    loop = Loop(ImaginedTable(own.p), own)
    loop.connect()
    own.tables.reset(0)
    loop.begin_point()
    loop.clear()
    for _ in range(STEPS):
        loop.step(own.tables.action_bounds.mean(axis=0).astype(np.float32))
        loop.observe()
