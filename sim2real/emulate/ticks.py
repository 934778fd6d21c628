"""How many instructions the flashed program's ticks take, whatever they have to do."""

from __future__ import annotations

from dataclasses import replace

from firmware import ELF
from puckpilot_env.parameters import make_records
from sim2real.emulate.gantry import Gantry
from sim2real.emulate.machine import Machine
from sim2real.link.frames import Receiver, encode, seal
from sim2real.link.messages import (
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
PER_TICK = 100  # bytes that the line brings in a tick, at 1 Mbaud
AHEAD = 12_000  # us from now to where a plan begins


def count_ticks() -> dict[str, int]:
    """The most instructions of a tick, by what was asked in it."""
    board = _Board()
    found = {"nothing to do": board.most(0.02)}
    asked = (Hello(*VERSION, SCHEMA, 1, 0), board.config, Home(*START), Arm(seal(board.config)))
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
    return found


class _Board:
    """A machine that counts, on a gantry."""

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
            (500.0, 500.0), (2.0, 2.0), 0.3, 500,
        )  # fmt: skip
        self.machine.run(40_000)
        self.telemetry = Telemetry(0, 0, 0, (0.0, 0.0), (0.0, 0.0), (0, 0), (0, 0), 0, 0, 0, 0)

    def most(self, seconds: float, *messages: object) -> int:
        """Of the ticks of so many seconds from now on, in which these are said."""
        self.machine.send(b"".join(encode(message) for message in messages))  # pyright: ignore[reportArgumentType]
        counts = self.machine.instructions(self.machine.now + 1e6 * seconds)
        for message in self.receiver.feed(self.machine.received()):
            self.telemetry = message if isinstance(message, Telemetry) else self.telemetry
        return max(counts)

    def new_trajectory(self) -> int:
        """Beside it as much as lets the board go on looking at it: two pings in each tick."""
        first = self.most(0.001, self.plan())
        return max(first, *(self.most(0.001, Ping(1), Ping(2)) for _ in range(14)))

    def flood(self, message: object) -> int:
        """While the line brings, as fast as it can, a configuration, the longest of all, then this message (or these
        bytes) for two ticks, in turn: what comes before it is done with in the same tick."""
        self.most(0.015, self.plan())
        one = message if isinstance(message, bytes) else encode(message)
        self.machine.send((encode(self.config) + one * (2 * PER_TICK // len(one))) * 8)
        most = max(self.machine.instructions(self.machine.now + 20_000))
        self.most(0.01)
        return most

    def plan(self) -> Traj:
        """From where the mallet is, somewhere."""
        self.sequence += 1
        (x, y), begin = self.gantry.axes, self.telemetry.time + AHEAD
        now = (self.machine.now + AHEAD) * 1e-6 - self.gantry.since
        modes = [axis.after(now) for axis in (x, y)]
        rest, slow, fast = zip(*modes, strict=True)
        plan = Traj(self.sequence, begin, 1_000_000, VOLTS, *SWITCHES, rest, slow, fast)
        return replace(plan, volts=(-VOLTS[0], -VOLTS[1])) if self.sequence % 2 == 0 else plan
