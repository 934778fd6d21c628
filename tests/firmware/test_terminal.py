"""The core as a program of this machine: a host talks to it over its pseudo-terminal, and a plan is followed."""

from __future__ import annotations

import os
import select
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from sim2real.link.wire.messages import Home, Ping, State, Telemetry, Traj
from tests.firmware.core.host_core import make
from tests.firmware.core.line import arm, config, frame, hello, read

START = (0.1, 0.2)
PATIENCE = 20.0  # s for what takes a fraction of one


class Host:
    """Pings all the while."""

    def __init__(self, port: int) -> None:
        self.port, self.rest = port, b""

    def send(self, *messages: object) -> None:
        os.write(self.port, b"".join(map(frame, messages)))

    def until(self, state: State, place: tuple[float, float] = (0.0, 0.0)) -> Telemetry:
        """The first telemetry that comes with this state and place."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            self.send(Ping(7))
            select.select([self.port], [], [], 0.01)
            whole, zero, self.rest = (self.rest + os.read(self.port, 4096)).rpartition(b"\0")
            expected = [one for one in read(whole + zero) if isinstance(one, Telemetry) and one.state == state]
            there = [one for one in expected if one.place == pytest.approx(place, abs=1e-4)]
            if there:
                return there[0]
        raise AssertionError(f"not {state.name} at {place} in {PATIENCE} s")


@contextmanager
def running(program: Path) -> Iterator[Host]:
    with subprocess.Popen([program], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        port = os.open(process.stdout.readline().strip(), os.O_RDWR | os.O_NOCTTY)
        try:
            yield Host(port)
        finally:
            os.close(port)
            process.kill()


def test_a_plan_is_followed_to_where_it_ends(tmp_path: Path) -> None:
    make("terminal", f"BUILD={tmp_path}")
    with running(tmp_path / "terminal") as host:
        host.until(State.UNHOMED)
        host.send(hello(), config(), Home(*START))
        host.until(State.IDLE, START)
        host.send(arm())
        expected = host.until(State.ARMED, START)
        # No volts: it coasts to its rest, as the slow mode fades.
        rest, slow, none = (0.15, 0.25), (-0.05, -0.05), (0.0, 0.0)
        host.send(Traj(1, expected.time + 50_000, 2_000_000, none, (0, 0), (0, 0), rest, slow, none))
        assert host.until(State.ARMED, rest).sequence == 1
