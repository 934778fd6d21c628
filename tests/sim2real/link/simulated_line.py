"""A board's clock and the delays of a line to it, in a time that the test makes: exchanges, and what is true."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

Delay = Callable[[np.random.Generator], float]


def usual(rng: np.random.Generator) -> float:
    """0.2 to 1.2 ms, and once in fifty times 10 ms more [s]."""
    return rng.uniform(0.2e-3, 1.2e-3) + (10e-3 if rng.random() < 0.02 else 0.0)


@dataclass
class Line:
    """A board whose clock shows `start` us at the host's 0 s and goes by `drift` too fast."""

    seed: int
    drift: float = 50e-6
    start: int = 123_456_789
    there: Delay = usual
    back: Delay = usual
    tick: float = 1e-3  # s: the board answers at the next multiple

    def board(self, host_s: float) -> float:
        """True time on the board's clock, not wrapped, not cut [us]."""
        return float(self.start + Fraction(host_s) * Fraction(1.0 + self.drift) * 1_000_000)

    def exchanges(self, seconds: float, rate: float = 20.0, begin: float = 5000.0) -> Iterator[tuple]:
        """Arguments of `BoardClock.add` at `rate` a second; host's clock begins at `begin` s."""
        rng = np.random.default_rng(self.seed)
        for k in range(round(seconds * rate)):
            sent = begin + k / rate
            received = sent + self.there(rng)
            answered = math.ceil(received / self.tick) * self.tick
            stamps = (int(self.board(t)) % 2**32 for t in (received, answered))
            yield sent, *stamps, answered + self.back(rng)


def error_us(line: Line, shown: int, host_s: float) -> float:
    """What the board's clock is said to show at `host_s`, less what it shows, the short way round [us]."""
    return (shown - line.board(host_s) + 2**31) % 2**32 - 2**31
