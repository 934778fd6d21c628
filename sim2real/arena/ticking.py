"""Steps on absolute deadlines: the n-th is due n periods after the first, whatever the ones before it took."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

MOST_BEHIND = 0.25  # s; what lags farther behind is not made up for, so that a machine that slept does not race


class Ticking:
    """Calls `step` so many times a second until it is stopped."""

    def __init__(self, step: Callable[[], None], rate: float) -> None:
        self._step, self._period = step, 1.0 / rate

    async def run(self) -> None:
        """Go on until cancelled."""
        loop = asyncio.get_running_loop()
        due = loop.time()
        while True:
            behind = loop.time() - due
            if behind > MOST_BEHIND:
                due += behind
            self._step()
            due += self._period
            await asyncio.sleep(max(due - loop.time(), 0.0))
