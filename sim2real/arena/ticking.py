"""Steps on absolute deadlines: the n-th is due n periods after the first, whatever the ones before it took."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Callable
from dataclasses import dataclass

from sim2real.garbage import collect_and_freeze

MOST_BEHIND = 0.25  # s; what lags farther behind is not made up for, so that a machine that slept does not race
SWITCH = 1e-4  # s after which a thread of work beside the games lets a tick go first


def avoid_pauses() -> None:
    """Keep the interpreter from delaying ticks, once all that they need is imported: by garbage collection, and since
    another thread holds the interpreter's lock for 5 ms by default, which a tick takes several times."""
    collect_and_freeze()
    sys.setswitchinterval(SWITCH)


@dataclass
class Lateness:
    """How far steps were behind their deadlines: of `steps`, `late` by over a period, the `latest` by so much [s];
    `lost` [s] was not made up for."""

    steps: int = 0
    late: int = 0
    latest: float = 0.0
    lost: float = 0.0

    def add(self, behind: float, period: float) -> None:
        """Count a step that is `behind` its deadline [s]."""
        self.steps += 1
        self.late += behind > period
        self.latest = max(self.latest, behind)


class Ticking:
    """Calls `step` so many times a second until it is stopped."""

    def __init__(self, step: Callable[[], None], rate: float, lateness: Lateness | None = None) -> None:
        """lateness: where steps are counted, with those of others."""
        self._step, self._period = step, 1.0 / rate
        self.lateness = lateness or Lateness()

    async def run(self) -> None:
        """Go on until cancelled."""
        loop = asyncio.get_running_loop()
        due = loop.time()
        while True:
            behind = loop.time() - due
            self.lateness.add(behind, self._period)
            if behind > MOST_BEHIND:
                due += behind
                self.lateness.lost += behind
            self._step()
            due += self._period
            await asyncio.sleep(max(due - loop.time(), 0.0))
