"""A board that speaks the protocol by frames made by hand: in simulated time, or behind a pseudo-terminal."""

from __future__ import annotations

import contextlib
import os
import pty
import struct
import threading
import time
import tty
from collections.abc import Callable
from pathlib import Path

from tests.sim2real.link.reference_wire import SCHEMA, frame, opened

UNHOMED, IDLE, ARMED, FAULT = 1, 2, 3, 4
HELLO, CONFIG, HOME, ARM, DISARM, ESTOP, CLEAR, TRAJ, PING = range(1, 10)


class FakeBoard:
    """Obeys as the protocol says, tick by tick, and keeps what it was sent."""

    def __init__(self, boots: int = 7, version: tuple[int, int] = (1, 1), schema: int = SCHEMA) -> None:
        self.boots, self.version, self.schema = boots, version, schema
        self.state, self.sequence, self.damaged = UNHOMED, 0, 0
        self.heard: list[tuple[int, bytes]] = []  # id and body of each message
        self.outbox: list[bytes] = []  # frames to send with the next tick
        self.mute: set[int] = set()  # ids that it does not answer
        self.telemetry_every = 2  # ticks
        self._kept = b""
        self._ticks = 0

    def step(self, now_us: int, data: bytes, read_us: int | None = None) -> bytes:
        """One tick, at `now_us` of its clock: what it says to what it was sent, and read at `read_us` if not now."""
        *coded, self._kept = (self._kept + data).split(b"\0")
        for one in filter(None, coded):
            message = opened(one)
            if message is None:
                self.damaged += 1
            else:
                self.heard.append(message)
                self._obey(*message, now_us if read_us is None else read_us)
        self._ticks += 1
        if self._ticks % self.telemetry_every == 0:
            self.outbox.insert(0, self.telemetry(now_us))
        said, self.outbox = b"".join(self.outbox), []
        return said

    def _obey(self, number: int, body: bytes, read_us: int) -> None:
        if number in self.mute:
            return
        if number == HELLO:
            token = struct.unpack("<BBIII", body)[3]
            self.outbox.append(frame(1, "BBIII", *self.version, self.schema, token, self.boots))
        elif number == PING:
            now = read_us % 2**32
            self.outbox.append(frame(10, "III", *struct.unpack("<I", body), now, now, schema=self.schema))
        elif number == TRAJ:
            self.sequence = struct.unpack("<I", body[:4])[0]
        self.state = {HOME: IDLE, ARM: ARMED, DISARM: IDLE, ESTOP: FAULT, CLEAR: UNHOMED}.get(number, self.state)

    def telemetry(self, now_us: int) -> bytes:
        """How it stands."""
        values = (
            now_us % 2**32,
            self.state,
            0,
            0.5,
            -0.25,
            0.5,
            -0.25,
            10,
            -20,
            5,
            6,
            self.sequence,
            self.damaged,
            0,
            99,
        )
        return frame(11, "IBBffffhhHHIHHH", *values, schema=self.schema)

    def count(self, number: int) -> int:
        """How often it heard message `number`."""
        return sum(one == number for one, _ in self.heard)


class Bench:
    """A line to a board in simulated time: each read takes a millisecond, in which the board does one tick."""

    def __init__(self, board: FakeBoard) -> None:
        self.board, self.time, self.drift = board, 100.0, 50e-6
        self.plugged = True
        self.opened = 0  # times
        self.tried: list[float] = []  # when it was tried to open it
        self.noise = b""  # comes with the next read
        self._written = b""

    def now(self) -> float:
        """The host's clock [s]."""
        return self.time

    def connect(self) -> Bench:
        """Open the line. OSError while it is unplugged."""
        self.tried.append(self.time)
        if not self.plugged:
            raise OSError("nothing plugged in")
        self.opened += 1
        self._written = b""
        return self

    def board_us(self) -> int:
        """The board's clock now, not wrapped."""
        return int((self.time * (1.0 + self.drift) + 4200.0) * 1e6)

    def read(self, most: int) -> bytes:
        """See `Line.read`."""
        self.time += 0.001
        if not self.plugged:
            raise OSError("unplugged")
        said, self.noise = self.noise, b""
        said += self.board.step(self.board_us(), self._written)
        self._written = b""
        return said

    def write(self, data: bytes) -> None:
        """See `Line.write`."""
        if not self.plugged:
            raise OSError("unplugged")
        self._written += data

    def close(self) -> None:
        """See `Line.close`."""


class Terminal:
    """A board behind a pseudo-terminal, found by the link `path`, in a thread of its own; `with` ends it."""

    def __init__(self, board: FakeBoard, path: Path) -> None:
        self.board, self.path = board, path
        self.damage = 0  # of so many bytes sent one is changed; 0 for none
        self.todo: list[Callable[[], None]] = []  # what the thread does next: plug, unplug, or a change of the board
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._there = False
        self._sent, self._heard = 0, b""
        self.plug()

    def __enter__(self) -> Terminal:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ending.set()
        self._thread.join()
        if self._there:
            self.unplug()

    def plug(self) -> None:
        """The port is there."""
        self._master, self._slave = pty.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self.path.symlink_to(os.ttyname(self._slave))
        self._there, self._waiting = True, b""

    def unplug(self) -> None:
        """The port vanishes."""
        self._there = False
        self.path.unlink()
        os.close(self._master)
        os.close(self._slave)

    def _run(self) -> None:
        begin, ticks = time.perf_counter(), 0
        while not self._ending.wait(0.001):
            if self.todo:
                self.todo.pop(0)()
            if self._there:
                with contextlib.suppress(OSError):
                    self._heard += os.read(self._master, 4096)
            read_us = int(1e6 * (time.perf_counter() - begin))
            while ticks < read_us // 1000:  # those that this thread was too late for, too, at their own times
                ticks += 1
                self._send(self.board.step(1000 * ticks, self._heard, read_us))
                self._heard = b""

    def _send(self, said: bytes) -> None:
        if not self._there:
            return
        for byte in said:
            self._sent += 1
            wrong = self.damage and self._sent % self.damage == 0
            self._waiting += bytes([byte ^ 1 if wrong else byte])
        with contextlib.suppress(BlockingIOError):
            self._waiting = self._waiting[os.write(self._master, self._waiting) :]
        if not self.board.count(HELLO):
            self._waiting = b""  # nobody listens yet
