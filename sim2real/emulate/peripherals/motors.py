"""The two motor drivers (Cytron MD30C): they turn the levels of their pins into a signed share of the supply."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

import numpy as np

from puckpilot_env.kernel import kernel
from sim2real.emulate.peripherals.gpio import PORT_B
from sim2real.emulate.peripherals.timers import pwm_duty
from sim2real.emulate.timeline import PER_US
from sim2real.emulate.unicorn_calls import DRIVE, address_of, call_drive

KEPT = 1_000_000  # changes: a quarter of an hour of play
PWM_PINS, DIRECTION_PINS = (13, 14), (12, 15)  # of port B, of motors 0 and 1

# duties: of both motors, -1 to 1; changed: address of the function that is called at each change
MOTORS = np.dtype([("duties", np.float64, 2), ("changed", np.int64)], align=True)


@kernel
def update_motors(board):
    """Recompute the duties after a write to a register behind the pins."""
    first, second = _duty(board, 0), _duty(board, 1)
    motors = board.motors
    if first != motors.duties[0] or second != motors.duties[1]:
        motors.duties[0], motors.duties[1] = first, second
        call_drive(motors.changed, board.timeline.now / PER_US, first, second)


@kernel
def _duty(board, motor):
    pin, port = PWM_PINS[motor], board.ports[PORT_B]
    high = pwm_duty(board.pwm, motor) if port.alternate >> pin & 1 else float(port.high >> pin & 1)
    return high if port.high >> DIRECTION_PINS[motor] & 1 or high == 0.0 else -high


class Motors:
    """What becomes of the duties. log: `(time [us], duty 0, duty 1)` at each of the last KEPT changes, with duties from
    -1 to 1; listeners: called with the same at each change.

    state: a record of MOTORS; failed: called with an error of a listener, which cannot be raised from here.
    """

    def __init__(self, state: np.void, failed: Callable[[BaseException], None]) -> None:
        self.listeners: list[Callable[[float, float, float], None]] = []
        self.log: deque[tuple[float, float, float]] = deque([(0.0, 0.0, 0.0)], maxlen=KEPT)
        self._failed = failed
        self._changed = DRIVE(self._note)  # kept as long as it is called
        state["changed"] = address_of(self._changed)

    @property
    def duties(self) -> tuple[float, float]:
        """The present duties, -1 to 1."""
        return self.log[-1][1:]

    def _note(self, time: float, first: float, second: float) -> None:
        try:
            if self.log[-1][0] == time and len(self.log) > 1:
                self.log.pop()
            self.log.append((time, first, second))
            for listen in self.listeners:
                listen(time, first, second)
        except BaseException as error:  # compiled code is between here and who handles it
            self._failed(error)
