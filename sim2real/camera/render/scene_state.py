"""The state of everything that moves on the table at one time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from sim2real.camera.render.table import Glint


class BodyState(NamedTuple):
    """Place [m] and velocity [m/s] of a body in the table's frame."""

    x: float
    y: float
    vx: float = 0.0
    vy: float = 0.0

    def after(self, time: float) -> BodyState:
        """The state a time [s] later, at constant velocity."""
        return self._replace(x=self.x + self.vx * time, y=self.y + self.vy * time)


@dataclass(frozen=True)
class SceneState:
    """What a picture shows: the puck, the opponent's mallet, and the robot's own under its gantry's beam; None if
    absent.

    time: middle of the exposure [s]; glints: reflections in addition to those of the table.
    """

    time: float = 0.0
    puck: BodyState | None = None
    opponent: BodyState | None = None
    mallet: BodyState | None = None
    glints: tuple[Glint, ...] = ()

    @property
    def bodies(self) -> list[BodyState]:
        """All bodies that are present."""
        return [body for body in (self.puck, self.opponent, self.mallet) if body is not None]
