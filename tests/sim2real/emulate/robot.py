"""The flashed program on the emulated chip, with a gantry on its motors' plugs and a host that pings it."""

from __future__ import annotations

from firmware import ELF
from puckpilot_env.physics.gantry.plan import switching_times
from sim2real.emulate.gantry import US, Gantry
from sim2real.emulate.machine import Machine
from sim2real.link.wire.messages import Event, Home, Notice, Ping, State, Telemetry, Traj
from tests.firmware.core.line import arm, config, frame, hello, read

START, TARGET = (0.1, 0.2), (0.5, 0.6)
ALIVE = Ping(7)


class Robot:
    """A machine with a gantry, and a host that pings it every 20 ms."""

    def __init__(self, **options) -> None:
        self.machine = Machine(ELF, **options)
        self.gantry = Gantry(self.machine, place=START, zero=(1.0, -2.5))
        self.heard: list = []
        self._sequence = 0
        self._rest = b""  # of a frame that is not yet over

    def run(self, duration: float, *messages: object, alive: bool = True) -> list:
        """Send, go on for so many us, and return what came."""
        self.machine.send(b"".join(map(frame, messages)))
        end, before = self.machine.now + duration, len(self.heard)
        while self.machine.now < end:
            if alive:
                self.machine.send(frame(ALIVE))
            self.machine.run(min(self.machine.now + 20_000, end))
        whole, zero, self._rest = (self._rest + self.machine.received()).rpartition(b"\0")
        self.heard += read(whole + zero)
        return self.heard[before:]

    def armed(self) -> Robot:
        """From power-on to ARMED."""
        self.run(30_000)
        self.run(6000, hello(), config(), Home(*START))
        self.run(6000, arm())
        assert self.telemetry.state == State.ARMED
        return self

    def sends(self, target: tuple[float, float], volts: float = 8.0) -> None:
        """A plan from where the mallet will be in 14 ms, if its volts stay as they are."""
        begin, board = self.machine.now + 14_000, self.telemetry.time + 14_000
        modes = [axis.after(begin * US - self.gantry.since) for axis in self.gantry.axes]
        plans = [
            switching_times(rest, slow, to, axis.rest_gain, axis.slow_gain, axis.slow_rate, volts)
            for axis, (rest, slow, _), to in zip(self.gantry.axes, modes, target, strict=True)
        ]
        t1, t2 = ((round(1e6 * plans[0][which]), round(1e6 * plans[1][which])) for which in (1, 2))
        signed = (volts * plans[0][0], volts * plans[1][0])
        self._sequence += 1
        self.machine.send(frame(Traj(self._sequence, board, 1_000_000, signed, t1, t2, *zip(*modes, strict=True))))

    def goes(self) -> Robot:
        """On its way from START to TARGET."""
        self.sends(TARGET)
        self.run(40_000)
        assert max(map(abs, self.machine.motors.duties)) > 0.1
        return self

    @property
    def telemetry(self) -> Telemetry:
        return [one for one in self.heard if isinstance(one, Telemetry)][-1]

    def events(self, notice: Notice) -> list[int]:
        return [one.detail for one in self.heard if isinstance(one, Event) and one.code == notice]
