"""What the robot's mallet does in a twin's plant, looked at every millisecond."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from puckpilot_env.game import mirror
from sim2real.table.twin.twin import Twin

AT_REST = 0.05  # m/s: slower a mallet stands


@dataclass
class Worst:
    """The worst that was seen: volts at a motor [V]; distance outside its area [m], negative inside."""

    volts: float = 0.0
    outside: float = -math.inf


class MalletMonitor:
    """Watches a twin's mallet. Replaces the twin's `pass_time` by one that looks after each millisecond."""

    def __init__(self, twin: Twin) -> None:
        self.worst, self.moving_at = Worst(), -math.inf
        self._planned: tuple[float, Callable[[], None]] | None = None
        self._twin, self._pass_time, self._area = twin, twin.pass_time, mirror.area(0, twin.p)
        twin.pass_time = self.pass_time

    def plan(self, time: float, happening: Callable[[], None]) -> None:
        """Call `happening` at `time` [s], in the middle of whatever goes on then."""
        self._planned = time, happening

    def pass_time(self, until: float) -> None:
        """Let time pass until `until` [s], and look at the mallet."""
        while self._twin.now() < until - 1e-9:
            self._pass_time(min(self._twin.now() + 1e-3, until))
            self._look()
            if self._planned is not None and self._twin.now() >= self._planned[0]:
                (_, happening), self._planned = self._planned, None
                happening()

    def _look(self) -> None:
        twin = self._twin
        x, y, vx, vy = twin.plant.mallet(0)
        x_low, x_high, y_low, y_high = self._area
        self.worst.outside = max(self.worst.outside, x_low - x, x - x_high, y_low - y, y - y_high)
        if twin.board is not None:
            self.worst.volts = max(self.worst.volts, twin.board.most_volts)
        if math.hypot(vx, vy) > AT_REST:
            self.moving_at = twin.now()

    @property
    def speed(self) -> float:
        """The mallet's speed now [m/s]."""
        _, _, vx, vy = self._twin.plant.mallet(0)
        return math.hypot(vx, vy)
