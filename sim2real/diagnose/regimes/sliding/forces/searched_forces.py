"""Forces whose place, time or period is searched: inside a span of time or of the table, pulses, and waves in time.

Their names hold what was found, so that a name alone makes the same force again.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from puckpilot_env.physics.effects.unlisted_force import BRAKE_BY_WAVE
from puckpilot_env.physics.effects.unlisted_window import OF_TIME, OF_X, OF_Y
from sim2real.diagnose.regimes.sliding.forces.motion import Motion, along_axes, scaled

COORDINATES: dict[str, tuple[int, str, Callable[[Motion], np.ndarray]]] = {
    "t": (OF_TIME, "s", lambda motion: motion.t),
    "x": (OF_X, "m", lambda motion: motion.place[:, 0]),
    "y": (OF_Y, "m", lambda motion: motion.place[:, 1]),
}  # kind of the simulator's window, unit, and values (n,)
NUMBER = r"(-?[\d.]+(?:e-?\d+)?)"


@dataclass(frozen=True)
class Span:
    """A `kind` of force, push or brake, where `low` <= coordinate `of` < `high` [s or m]; of a time with `every` [s]
    again and again."""

    kind: str
    of: str
    low: float
    high: float
    every: float = 0.0

    @property
    def name(self) -> str:
        """Its name, from which `searched_force` makes it again."""
        unit = COORDINATES[self.of][1]
        again = f", every {self.every:.4f} s" if self.every else ""
        return f"{self.kind} from {self.of} = {self.low:.4f} {unit} to {self.high:.4f} {unit}{again}"

    @property
    def depends(self) -> str:
        """The quantity that it depends on."""
        return "time" if self.of == "t" else "position"

    def inside(self, motion: Motion) -> np.ndarray:
        """1 (n,) inside, 0 outside."""
        since = COORDINATES[self.of][2](motion) - self.low
        if self.every:
            since = since % self.every
        return ((since >= 0.0) & (since < self.high - self.low)).astype(float)

    def force(self, motion: Motion) -> np.ndarray:
        """Accelerations (n, 2, k) [m/s^2] for each coefficient: along x and y of a push, against the motion of a
        brake."""
        vectors = along_axes(motion) if self.kind == "push" else (-motion.along,)
        return scaled(self.inside(motion)[:, None], *vectors)

    def effect(self, amounts: np.ndarray) -> dict[str, float]:
        """The simulator's parameters for `amounts` (k,) [m/s^2]."""
        names = ("window_push_x", "window_push_y") if self.kind == "push" else ("window_brake",)
        span = {"window_from": self.low, "window_until": self.high, "window_every": self.every}
        return {
            "window_kind": float(COORDINATES[self.of][0]),
            **span,
            **dict(zip(names, map(float, amounts), strict=True)),
        }


@dataclass(frozen=True)
class Wave:
    """A brake by a wave in time of a `period` [s]."""

    period: float

    @property
    def name(self) -> str:
        """Its name, from which `searched_force` makes it again."""
        return f"brake by a wave of {self.period:.4f} s"

    @property
    def depends(self) -> str:
        """The quantity that it depends on."""
        return "time"

    def force(self, motion: Motion) -> np.ndarray:
        """Decelerations (n, 2, 2) [m/s^2] in proportion to a sine and a cosine of the time."""
        turns = 2.0 * np.pi * motion.t / self.period
        return scaled(np.stack([np.sin(turns), np.cos(turns)], axis=1), -motion.along)

    def effect(self, amounts: np.ndarray) -> dict[str, float]:
        """The simulator's parameters for `amounts` (2,) [m/s^2] of sine and cosine."""
        numbers = (BRAKE_BY_WAVE, self.period, *amounts)
        names = ("unlisted_kind", "unlisted_00", "unlisted_01", "unlisted_02")
        return dict(zip(names, map(float, numbers), strict=True))


_SPAN = re.compile(rf"(push|brake) from ([txy]) = {NUMBER} \w+ to {NUMBER} \w+(?:, every {NUMBER} s)?")
_WAVE = re.compile(rf"brake by a wave of {NUMBER} s")


def searched_force(name: str) -> Span | Wave | None:
    """The force of this name; None if it is not one of these."""
    if span := _SPAN.fullmatch(name):
        kind, of, low, high, every = span.groups()
        return Span(kind, of, float(low), float(high), float(every or 0.0))
    wave = _WAVE.fullmatch(name)
    return Wave(float(wave[1])) if wave else None
