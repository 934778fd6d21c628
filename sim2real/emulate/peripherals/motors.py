"""The two motor drivers (Cytron MD30C): they turn the levels of their pins into a signed share of the supply."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from sim2real.emulate.peripherals.gpio import GpioPort
from sim2real.emulate.peripherals.timers import PwmTimer

KEPT = 1_000_000  # changes: a quarter of an hour of play
PWM_PINS, DIRECTION_PINS = (13, 14), (12, 15)  # of port B, of motors 0 and 1


class Motors:
    """Both drivers. log: `(time [us], duty 0, duty 1)` at each of the last KEPT changes, with duties from -1 to 1;
    listeners: called with the same at each change."""

    def __init__(self, port: GpioPort, timer: PwmTimer, now: Callable[[], float]) -> None:
        self._port, self._timer, self._now = port, timer, now
        self.listeners: list[Callable[[float, float, float], None]] = []
        self.log: deque[tuple[float, float, float]] = deque([(0.0, 0.0, 0.0)], maxlen=KEPT)

    @property
    def duties(self) -> tuple[float, float]:
        """The present duties, -1 to 1."""
        return self.log[-1][1:]

    def update(self) -> None:
        """Recompute the duties after a write to a register behind the pins."""
        duties = self._duty(0), self._duty(1)
        if duties == self.duties:
            return
        now = self._now()
        if self.log[-1][0] == now and len(self.log) > 1:
            self.log.pop()
        self.log.append((now, *duties))
        for listen in self.listeners:
            listen(now, *duties)

    def _duty(self, motor: int) -> float:
        pin = PWM_PINS[motor]
        high = self._timer.duty(motor) if self._port.alternate >> pin & 1 else float(self._port.high >> pin & 1)
        return high if self._port.high >> DIRECTION_PINS[motor] & 1 or not high else -high
