"""What the two motor drivers (Cytron MD30C) make of their pins: a signed share of the supply."""

from __future__ import annotations

from collections.abc import Callable

from sim2real.emulate.gpio import Port
from sim2real.emulate.timers import PwmTimer

PWM_PINS, DIRECTION_PINS = (13, 14), (12, 15)  # of port B, of motors 0 and 1


class Motors:
    """`log` holds `(time [us], duty 0, duty 1)`, duties from -1 to 1, at each change; `listeners` hear of each."""

    def __init__(self, port: Port, timer: PwmTimer, now: Callable[[], float]) -> None:
        self._port, self._timer, self._now = port, timer, now
        self.listeners: list[Callable[[float, float, float], None]] = []
        self.log: list[tuple[float, float, float]] = [(0.0, 0.0, 0.0)]

    @property
    def duties(self) -> tuple[float, float]:
        """What the motors get now."""
        return self.log[-1][1:]

    def look(self) -> None:
        """A register behind the pins was written."""
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
        high = self._timer.duty(motor) if self._port.lent(pin) else float(self._port.level(pin) or 0)
        return high if self._port.level(DIRECTION_PINS[motor]) or not high else -high
