"""A bench for the core: two encoders that can fail, a gantry that obeys its equation, and a host's end of the line."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from puckpilot_env.physics.gantry.mallet import axis_constants
from puckpilot_env.physics.gantry.plan import switching_times
from sim2real.link.wire import messages
from tests.firmware.core.host_core import Core, Step
from tests.firmware.core.line import arm, config, frame, hello, read

TARGET = (0.6, 0.7)  # m: where it is mostly sent
PLAYS = 60  # ticks into a trajectory: both motors are driven
CORNER = (0.1, 0.2)  # m: where the mallet stands in the beginning
FULL = 3600
TURN = 16384
SPARE = 0x4000  # bit of an answer by which an encoder tells of an error
ANGLE, ERRORS, HEALTH = 0xFFFF, 0x4001, 0xFFFC


def with_parity(word: int) -> int:
    """The word with bit 15 such that its ones are even."""
    return (word & 0x7FFF) | ((word & 0x7FFF).bit_count() % 2) << 15


class Encoder:
    """An AS5147, asked twice by its board. `spoil` changes its answers."""

    def __init__(self) -> None:
        self.spoil: Callable[[int], int] = lambda answer: answer
        self.frozen: int | None = None

    def exchange(self, command: int, angle: float) -> int:
        """The answer to a command; angle [turns]."""
        value = int(np.floor(angle * TURN)) % TURN if self.frozen is None else self.frozen
        answer = {ANGLE: value, HEALTH: 0x0180, ERRORS: 0}.get(command, 0)
        return self.spoil(with_parity(answer))


@dataclass
class Axis:
    """One axis of the gantry, in modes; exact while the voltage is constant."""

    constants: tuple[float, float, float, float, float]
    rest: float
    slow: float = 0.0
    fast: float = 0.0

    def go_on(self, volts: float, seconds: float) -> None:
        slow_rate, fast_rate, rest_gain, slow_gain, fast_gain = self.constants
        self.rest += rest_gain * volts * seconds
        slow_end, fast_end = -slow_gain * volts, fast_gain * volts
        self.slow = slow_end + (self.slow - slow_end) * np.exp(-slow_rate * seconds)
        self.fast = fast_end + (self.fast - fast_end) * np.exp(-fast_rate * seconds)

    @property
    def place(self) -> float:
        return self.rest + self.slow + self.fast

    @property
    def speed(self) -> float:
        slow_rate, fast_rate, *_ = self.constants
        return -slow_rate * self.slow - fast_rate * self.fast

    def push(self, speed: float) -> None:
        """Give it this speed [m/s], where it is."""
        slow = -speed / self.constants[0]
        self.rest, self.slow, self.fast = self.place - slow, slow, 0.0


@dataclass
class Bench:
    """The core on its bench. `wires`: which encoder and motor are on which plug, and turned round how; `late`: time by
    which the motors obey late [us]."""

    config: messages.Config = field(default_factory=config)
    now: int = 1_000_000
    start: tuple[float, float] = CORNER
    wires: tuple[tuple[int, int], tuple[int, int]] = ((0, 1), (1, 1))
    blocked: bool = False
    late: int = 0
    heard: list = field(default_factory=list)
    waiting: bytes = b""
    sequence: int = 0

    def __post_init__(self) -> None:
        self.core = Core()
        self.encoders = (Encoder(), Encoder())
        c = self.config
        constants = [axis_constants(c.c5[i], c.c6[i], c.c7[i], c.pulley_radius) for i in range(2)]
        self.axes = [Axis(constants[i], self.start[i]) for i in range(2)]
        self.pwm, self.commands = (0, 0), (0, 0)
        self.orders = [(0, 0)] * (2 + self.late // 1000)  # of the motors, the newest first
        self.telemetry: messages.Telemetry | None = None

    def send(self, *what: object) -> None:
        """To be heard in the next tick: messages, or bytes."""
        self.waiting += b"".join(one if isinstance(one, bytes) else frame(one) for one in what)

    def tick(self, *, missed: int = 0, lost: int = 0) -> Step:
        """A millisecond (or more, where ticks are missed): the motors turn, then the core looks."""
        for _ in range(missed + 1):
            self._move()
        self.now = (self.now + 1000 * (missed + 1)) % 2**32
        received, self.waiting = self.waiting, b""
        step = self.core.step(self.now, self._answers(), received, missed=missed, lost=lost)
        self.pwm, self.commands = step.pwm, step.commands
        for message in read(step.sent):
            self.heard.append(message)
            if isinstance(message, messages.Telemetry):
                self.telemetry = message
        return step

    def run(self, ticks: int, *, alive: bool = True) -> None:
        """So many ticks, with a ping every 20 of them."""
        for number in range(ticks):
            if alive and number % 20 == 0:
                self.send(messages.Ping(number))
            self.tick()

    def _move(self) -> None:
        if self.blocked:
            return
        self.orders = [self.pwm, *self.orders[:-1]]
        first = self.late % 1000
        for order, lasts in ((self.orders[-1], first), (self.orders[-2], 1000 - first)):
            volts = [self.config.supply * duty / FULL for duty in order]
            for axis, u in zip(self.axes, (volts[0] - volts[1], -volts[0] - volts[1]), strict=True):
                axis.go_on(u, 1e-6 * lasts)

    def _answers(self) -> tuple[int, int]:
        radius = self.config.pulley_radius
        x, y = self.place
        turns = np.array([x - y, -x - y]) / radius / (2 * np.pi)
        plugged = [sign * turns[which] for which, sign in self.wires]
        one, other = self.encoders
        return one.exchange(self.commands[0], plugged[0]), other.exchange(self.commands[1], plugged[1])

    @property
    def place(self) -> tuple[float, float]:
        """Where the mallet truly is [m]."""
        return self.axes[0].place, self.axes[1].place

    @property
    def speed(self) -> tuple[float, float]:
        """Of the mallet, truly [m/s]."""
        return self.axes[0].speed, self.axes[1].speed

    @property
    def state(self) -> int:
        """As the last telemetry has it."""
        self.tick()
        self.tick()
        assert self.telemetry is not None
        return self.telemetry.state

    def events(self, notice: messages.Notice) -> list[int]:
        """Details of the events of this kind so far."""
        return [one.detail for one in self.heard if isinstance(one, messages.Event) and one.code == notice]

    @property
    def refusals(self) -> list[tuple[int, int]]:
        """Id of the message and reason, of everything that was refused."""
        return [(detail >> 8, detail & 255) for detail in self.events(messages.Notice.REFUSED)]

    def armed(self) -> Bench:
        """Through hello, configuration and homing to ARMED."""
        self.run(30)
        self.send(hello(), self.config, messages.Home(*self.start))
        self.run(2)
        self.send(arm(self.config))
        self.run(1)
        assert self.state == messages.State.ARMED
        return self

    def trajectory(self, target: tuple[float, float], volts: tuple[float, float] = (8.0, 8.0), **changed: object):
        """A plan from where the mallet truly is, beginning in 10 ms."""
        self.sequence += 1
        plans = [
            switching_times(axis.rest, axis.slow, to, axis.constants[2], axis.constants[3], axis.constants[0], u)
            for axis, to, u in zip(self.axes, target, volts, strict=True)
        ]
        times = [tuple(round(1e6 * plan[which]) for plan in plans) for which in (1, 2)]
        fields = {
            "sequence": self.sequence, "apply": (self.now + 10_000) % 2**32, "life": 1_000_000,
            "volts": tuple(sign * u for (sign, *_), u in zip(plans, volts, strict=True)),
            "t1": times[0], "t2": times[1],
            "rest": tuple(axis.rest for axis in self.axes), "slow": tuple(axis.slow for axis in self.axes),
            "fast": tuple(axis.fast for axis in self.axes),
        }  # fmt: skip
        return messages.Traj(**{**fields, **changed})


def until_stopped(bench: Bench, most: int, *, alive: bool = True) -> int:
    """Ticks until the motors are off for good."""
    for number in range(1, most + 1):
        if alive and number % 20 == 0:
            bench.send(messages.Ping(number))
        bench.tick()
        if bench.pwm == (0, 0) and bench.events(messages.Notice.FAULTED):
            return number
    raise AssertionError(f"still driven after {most} ticks")
