"""What moves, at one time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from sim2real.camera.render.table import Glint


class Motion(NamedTuple):
    """Place [m] and velocity [m/s] in the table's frame."""

    x: float
    y: float
    vx: float = 0.0
    vy: float = 0.0

    def after(self, time: float) -> Motion:
        """The same `time` [s] later, at constant velocity."""
        return self._replace(x=self.x + self.vx * time, y=self.y + self.vy * time)


@dataclass(frozen=True)
class Moment:
    """Puck, opponent's mallet and the robot's own, which hangs under its gantry's beam; None: not on the table.

    time: middle of the exposure [s]; glints: reflections that are there now, besides those of the table.
    """

    time: float = 0.0
    puck: Motion | None = None
    opponent: Motion | None = None
    mallet: Motion | None = None
    glints: tuple[Glint, ...] = ()

    @property
    def movers(self) -> list[Motion]:
        """All that is there."""
        return [mover for mover in (self.puck, self.opponent, self.mallet) if mover is not None]
