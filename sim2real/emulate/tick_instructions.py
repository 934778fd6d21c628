"""Count the instructions of the flashed program's control ticks under various loads."""

from __future__ import annotations

from dataclasses import replace

from firmware import ELF
from puckpilot_env.parameters import make_records
from sim2real.emulate.gantry import Gantry
from sim2real.emulate.machine import Machine
from sim2real.link.wire.frames import Receiver, encode, frame_crc
from sim2real.link.wire.messages import (
    SCHEMA,
    VERSION,
    Arm,
    Clear,
    Config,
    Disarm,
    Hello,
    Home,
    Ping,
    State,
    Telemetry,
    Traj,
)

START = (0.3, 0.3)  # m
VOLTS, SWITCHES = (8.0, -6.0), ((90_000, 60_000), (150_000, 100_000))
PER_TICK = 100  # bytes that arrive in a tick at 1 Mbaud
AHEAD = 12_000  # us from now to the beginning of a plan
LATE = 4_500  # us by which motors obey late: between two ticks, which takes the board most


def count_ticks() -> dict[str, int]:
    """The greatest number of instructions of a tick, by what the tick has to do. Raises RuntimeError if the board does
    not reach or keep the state ARMED."""
    board = _Board()
    found = {"nothing to do": board.most(0.02)}
    asked = (Hello(*VERSION, SCHEMA, 1, 0), board.config, Home(*START), Arm(frame_crc(board.config)))
    for message in asked:
        name = type(message).__name__.lower()
        found[f"a {name}" if name != "arm" else "an arm"] = board.most(0.005, message)
    if board.telemetry.state != State.ARMED:
        raise RuntimeError(f"the board is in state {board.telemetry.state}; expected it to be armed")
    board.most(0.015, board.plan())
    found["play"] = board.most(0.02)
    found["play, a ping answered"] = max(board.most(0.003, Ping(number)) for number in range(8))
    found["play, a new trajectory"] = max(board.new_trajectory() for _ in range(4))
    refused = (*asked, Clear(), board.plan(), Ping(1), b"\0", b"\1\0")  # in this state, or nothing at all
    found["play, the line full of what is refused"] = max(map(board.flood, refused))
    if board.telemetry.state != State.ARMED:
        raise RuntimeError(f"the board is in state {board.telemetry.state}; expected a flood to be borne")
    board.most(0.005, Disarm())
    found["no play, the line full of what is done"] = max(map(board.flood, (*asked[:3], Ping(1))))
    found["braking, the line full of what is refused"] = max(map(board.flood_while_braking, refused))
    return found


class _Board:
    """A timed machine with a gantry."""

    def __init__(self) -> None:
        self.machine = Machine(ELF, timed=True)
        self.gantry = Gantry(self.machine, place=START)
        self.receiver = Receiver()
        self.sequence = 0
        p = make_records(1)[0]
        minus, plus = ([float(p[f"a{n}"] + sign * p[f"b{n}"]) for n in (1, 2, 3)] for sign in (-1, 1))
        c5, c6, c7 = zip(minus, plus, strict=True)
        self.config = Config(
            c5, c6, c7, float(p["pulley_radius"]), 24.0, 20.0, (0.05, 0.95), (0.05, 0.95), (400.0, 400.0),
            (500.0, 500.0), (2.0, 2.0), 0.3, 500, LATE,
        )  # fmt: skip
        self.machine.run(40_000)
        self.telemetry = Telemetry(0, 0, 0, (0.0, 0.0), (0.0, 0.0), (0, 0), (0, 0), 0, 0, 0, 0)

    def most(self, seconds: float, *messages: object) -> int:
        """Send messages and run for so many seconds. Returns the greatest number of instructions of a tick."""
        self.machine.send(b"".join(encode(message) for message in messages))  # pyright: ignore[reportArgumentType]
        counts = self.machine.instructions(self.machine.now + 1e6 * seconds)
        for message in self.receiver.feed(self.machine.received()):
            self.telemetry = message if isinstance(message, Telemetry) else self.telemetry
        return max(counts)

    def new_trajectory(self) -> int:
        """Send a trajectory, and two pings in each tick while the board checks it: as much load as the check allows."""
        first = self.most(0.001, self.plan())
        return max(first, *(self.most(0.001, Ping(1), Ping(2)) for _ in range(14)))

    def flood(self, message: object) -> int:
        """Saturate the line: alternately a configuration, the longest message, and two ticks full of this message (or
        these bytes). Returns the greatest number of instructions of a tick."""
        self.most(0.015, self.plan())
        return self._saturate(message)

    def flood_while_braking(self, message: object) -> int:
        """The same while the board brakes a moving mallet."""
        self.most(0.005, Arm(frame_crc(self.config)))
        self.most(0.08, self.plan())
        self.machine.send(encode(Disarm()))
        return self._saturate(message)

    def _saturate(self, message: object) -> int:
        one = message if isinstance(message, bytes) else encode(message)
        self.machine.send((encode(self.config) + one * (2 * PER_TICK // len(one))) * 8)
        most = max(self.machine.instructions(self.machine.now + 20_000))
        self.most(0.01)
        return most

    def plan(self) -> Traj:
        """The next plan, which starts at the mallet's place; its direction alternates."""
        self.sequence += 1
        (x, y), begin = self.gantry.axes, self.telemetry.time + AHEAD
        now = (self.machine.now + AHEAD) * 1e-6 - self.gantry.since
        modes = [axis.after(now) for axis in (x, y)]
        rest, slow, fast = zip(*modes, strict=True)
        plan = Traj(self.sequence, begin, 1_000_000, VOLTS, *SWITCHES, rest, slow, fast)
        return replace(plan, volts=(-VOLTS[0], -VOLTS[1])) if self.sequence % 2 == 0 else plan
