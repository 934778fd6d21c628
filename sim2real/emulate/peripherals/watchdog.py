"""The independent watchdog IWDG: it resets the microcontroller unless it is reloaded in time."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import ClassVar

from sim2real.emulate.peripherals.registers import NotModelledError, Peripheral
from sim2real.emulate.timeline import PER_US, Timeline

_KICK, _UNLOCK, _START = 0xAAAA, 0x5555, 0xCCCC
_UPDATE = 5  # cycles of its clock until a new value takes effect


class Watchdog(Peripheral):
    """The watchdog with its own RC oscillator of `kilohertz`, 30 to 60 by the data sheet. `bite` is called when it
    expires."""

    name, base = "IWDG", 0x40003000
    offsets = ("KR", "PR", "RLR", "SR")
    start: ClassVar[dict[str, int]] = {"RLR": 0xFFF}

    def __init__(self, timeline: Timeline, wait: Callable[[int], bool], bite: Callable[[], None]) -> None:
        self._timeline, self._wait, self._bite = timeline, wait, bite
        self.kilohertz = 40.0
        super().__init__()

    def reset(self) -> None:
        """Set the state after a reset: stopped."""
        super().reset()
        self._open = self._running = False
        self._deadline = self._busy_until = self._event = 0
        self._check_at: float = math.inf  # tick of the scheduled check

    def _ticks(self, cycles: float) -> int:
        return round(cycles * 1000.0 * PER_US / self.kilohertz)

    def get(self, register: str) -> int:
        """Read a register. A read of SR takes until the update is over, because the program polls it."""
        if register == "SR" and self._timeline.now < self._busy_until:
            return 0 if self._wait(self._busy_until) else 3
        return self.values[register]

    def set(self, register: str, value: int) -> None:
        """See `Peripheral`."""
        if register == "KR":
            self._open = value == _UNLOCK
            self._running |= value == _START
            if self._running and value in (_START, _KICK):
                self._kick()
        elif not self._open:
            raise NotModelledError(f"IWDG_{register} is written while locked: without effect")
        else:
            self.values[register] = value
            self._busy_until = self._timeline.now + self._ticks(_UPDATE)

    def _kick(self) -> None:
        prescaler = 4 << min(self.values["PR"], 6)
        self._deadline = self._timeline.now + self._ticks(prescaler * (self.values["RLR"] + 1))
        if self._deadline < self._check_at:  # otherwise the scheduled check comes in time and repeats itself
            self._timeline.drop(self._event)
            self._schedule_check()

    def _schedule_check(self) -> None:
        self._check_at = self._deadline
        self._event = self._timeline.at(self._deadline, self._due)

    def _due(self) -> None:
        if self._timeline.now >= self._deadline:
            self._bite()
        else:
            self._schedule_check()
