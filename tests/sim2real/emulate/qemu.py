"""The core in QEMU, an emulator that shares nothing with ours: firmware/board/qemu, driven from here in lock-step."""

from __future__ import annotations

import shutil
import struct
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import pytest

from firmware import QEMU_ELF
from tests.firmware.core.host_core import ZEROS, Step

COMMAND = (
    "qemu-system-arm", "-machine", "netduino2", "-nodefaults", "-display", "none", "-no-reboot", "-serial", "stdio",
    "-kernel", str(QEMU_ELF),
)  # fmt: skip
START, TICK, OUTPUT = struct.Struct("<2I"), struct.Struct("<I7Hxx"), struct.Struct("<2h3H")


@contextmanager
def in_qemu(cause: int = 0, boots: int = 1) -> Iterator[QemuCore]:
    """A robot from its start on; a skip where there is no QEMU."""
    if not shutil.which(COMMAND[0]):
        pytest.skip("qemu-system-arm is not installed (Debian: qemu-system-arm): nothing is compared with it")
    process = subprocess.Popen(COMMAND, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    try:
        yield QemuCore(process, START.pack(cause, boots))
    finally:
        process.kill()
        process.communicate()


class QemuCore:
    """A robot, as `tests.firmware.core.host_core.Core` is one."""

    def __init__(self, process: subprocess.Popen[bytes], start: bytes) -> None:
        assert process.stdin is not None and process.stdout is not None
        self._to, self._from = process.stdin, process.stdout
        assert self._take(1) == b"\0"
        self._give(start)

    def step(
        self, now: int, answers: tuple[int, int], received: bytes = b"", *, missed: int = 0, lost: int = 0,
        took: int = 0, stamps: Sequence[int] = (),
    ) -> Step:  # fmt: skip
        """A tick at `now` [us], at which all that was received came, unless there are `stamps` of its zeros."""
        zeros = (*(stamps or [now] * ZEROS),)[: received.count(0)]
        given = TICK.pack(now, missed, lost, *answers, took, len(received), len(zeros))
        self._give(given + received + struct.pack(f"<{len(zeros)}I", *zeros))
        *numbers, count = OUTPUT.unpack(self._take(OUTPUT.size))
        return Step((numbers[0], numbers[1]), (numbers[2], numbers[3]), self._take(count))

    def _give(self, data: bytes) -> None:
        self._to.write(data)
        self._to.flush()

    def _take(self, count: int) -> bytes:
        data = self._from.read(count)
        assert len(data) == count, "the program in QEMU came to a halt"
        return data
