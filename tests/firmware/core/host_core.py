"""The firmware's core, built for this machine and driven from here: this side plays the board."""

from __future__ import annotations

import ctypes as c
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import pytest

from firmware import FOLDER

SEND, ZEROS = 192, 8


def make(*words: str) -> str:
    """What the firmware's Makefile says of these; a skip where this machine cannot build it."""
    if not shutil.which("make") or not shutil.which("cc"):
        pytest.skip("no make or no C compiler here: the core cannot be built for this machine")
    command = ["make", "-s", "-C", str(FOLDER), *words]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


@cache
def library() -> c.CDLL:
    """The core as a shared library."""
    build = Path(mkdtemp(prefix="core-"))
    make("host", f"BUILD={build}")
    return c.CDLL(str(build / "library.so"))


class Input(c.Structure):
    _fields_ = [
        ("now", c.c_uint32), ("missed", c.c_uint16), ("lost", c.c_uint16), ("answers", c.c_uint16 * 2),
        ("bytes", c.c_char_p), ("count", c.c_uint16), ("zeros", c.POINTER(c.c_uint32)), ("took", c.c_uint16),
    ]  # fmt: skip


class Output(c.Structure):
    _fields_ = [
        ("pwm", c.c_int16 * 2), ("commands", c.c_uint16 * 2), ("count", c.c_uint16), ("bytes", c.c_uint8 * SEND),
    ]  # fmt: skip


@dataclass
class Step:
    """What a tick brought."""

    pwm: tuple[int, int]
    commands: tuple[int, int]
    sent: bytes


@dataclass
class Core:
    """A robot from its start on; `step` is one tick."""

    cause: int = 0
    boots: int = 1
    robot: c.Array = field(init=False)
    kept: c.Array = field(init=False)

    def __post_init__(self) -> None:
        self.kept = c.create_string_buffer(library().kept_size())
        self.start()

    def start(self) -> None:
        """From a reset on, by which nothing remains but what is kept."""
        self.robot = c.create_string_buffer(library().robot_size())
        library().robot_start(self.robot, self.cause, self.boots, self.kept)

    def step(
        self, now: int, answers: tuple[int, int], received: bytes = b"", *, missed: int = 0, lost: int = 0,
        took: int = 0, stamps: Sequence[int] = (),
    ) -> Step:  # fmt: skip
        """A tick at `now` [us], at which all that was received came, unless there are `stamps` of its zeros."""
        zeros = (c.c_uint32 * ZEROS)(*(stamps or [now] * ZEROS))
        given = Input(now, missed, lost, (c.c_uint16 * 2)(*answers), received, len(received), zeros, took)
        out = Output()
        library().robot_step(self.robot, c.byref(given), c.byref(out))
        return Step(tuple(out.pwm), tuple(out.commands), bytes(out.bytes[: out.count]))
