"""Parts of the emulator against what their data sheets say, worked out by hand, and the gantry against its equation."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.sim2real.emulate.built import PLAIN, need_compiler

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from sim2real.emulate.elf import read_elf
from sim2real.emulate.gantry import Gantry
from sim2real.emulate.machine import Machine
from sim2real.emulate.peripherals.as5147 import As5147
from sim2real.emulate.peripherals.nvic import Nvic
from sim2real.emulate.peripherals.registers import NotModelledError
from sim2real.emulate.timeline import Timeline

ANGLE, NOTHING, ERRORS, HEALTH, BAD_PARITY, WRITE = 0xFFFF, 0xC000, 0x4001, 0xFFFC, 0x7FFF, 0x3FFF


def _answer(encoder: As5147, command: int) -> int:
    encoder.exchange(command, 0)
    return encoder.exchange(NOTHING, 0)


def _quarter() -> As5147:
    encoder = As5147()
    encoder.angle = lambda now: 2 * np.pi * (0.25 + 1e-6) + 20 * np.pi
    return encoder


def test_an_encoder_answers_in_the_next_frame_with_even_parity() -> None:
    encoder = _quarter()
    assert encoder.exchange(ANGLE, 0) == 0
    assert encoder.exchange(HEALTH, 0) == 0b1001_0000_0000_0000  # 4096 steps have one bit set: parity makes it two
    assert encoder.exchange(NOTHING, 0) == 0b0000_0001_1000_0000  # loops finished, gain 128
    encoder.angle = lambda now: -1e-9
    assert _answer(encoder, ANGLE) == 0b0011_1111_1111_1111


@pytest.mark.parametrize(("wrong", "says"), [(BAD_PARITY, 4), (WRITE, 2), (0x4123 | 0x8000, 2)])
def test_a_wrong_command_raises_the_flag_until_errors_are_read(wrong: int, says: int) -> None:
    encoder = _quarter()
    assert _answer(encoder, wrong) & 0x4000
    assert _answer(encoder, ANGLE) == 0b0101_0000_0000_0000
    assert _answer(encoder, ERRORS) & 0x3FFF == says
    assert _answer(encoder, ANGLE) == 0b1001_0000_0000_0000


def test_faults_of_an_encoder_look_as_they_are_named() -> None:
    encoder = _quarter()
    answers = {}
    for fault in ("parity", "error", "low", "high", "jump", ""):
        encoder.fault = fault
        answers[fault] = _answer(encoder, ANGLE)
    assert answers == {"parity": 0x1000, "error": 0x5000, "low": 0, "high": 0xFFFF, "jump": 0x97D0, "": 0x9000}
    encoder.fault = "frozen"
    _answer(encoder, ANGLE)
    encoder.angle = lambda now: 1.0
    assert _answer(encoder, ANGLE) == 0x9000
    with pytest.raises(ValueError, match="expected one of"):
        encoder.fault = "tired"


def test_symbols_and_segments_are_those_that_binutils_see() -> None:
    need_compiler()
    elf = read_elf(PLAIN)
    listed = subprocess.run(["arm-none-eabi-nm", str(PLAIN)], capture_output=True, text=True, check=True).stdout
    lines = [line.split() for line in listed.splitlines()]
    assert {name: int(address, 16) for address, _, name in lines} == elf.symbols
    assert elf.segments[0].address == 0x08000000 and elf.segments[0].executable
    with pytest.raises(KeyError, match="not stripped"):
        elf.address("nowhere")


def test_what_is_no_program_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "text.elf"
    path.write_bytes(b"hello")
    with pytest.raises(ValueError, match=r"text\.elf: expected a 32-bit"):
        read_elf(path)
    path.write_bytes(b"\x7fELF\x01\x01" + bytes(60))
    with pytest.raises(ValueError, match="machine is 0"):
        read_elf(path)


def test_events_come_in_order_and_dropped_ones_do_not() -> None:
    timeline, seen = Timeline(), []
    timeline.at(20, lambda: seen.append("late"))
    dropped = timeline.at(10, lambda: seen.append("dropped"))
    timeline.at(15, lambda: seen.append("first"))
    timeline.at(15, lambda: seen.append("second"))
    timeline.drop(dropped)
    while timeline.next() is not None:
        timeline.step()
    assert seen == ["first", "second", "late"] and timeline.now == 20


def test_the_more_urgent_exception_is_served_and_interrupts_the_other() -> None:
    nvic = Nvic()
    nvic.write(0x100, 1 << 14, 4)
    nvic.write(0x104, 1 << 5, 4)
    nvic.write(0x400 + 14, 0x4F, 1)
    nvic.line(14, True)
    assert nvic.next() == 30
    nvic.enter(30)
    assert nvic.next() is None
    nvic.line(37, True)
    assert nvic.next() == 53
    nvic.enter(53)
    nvic.line(37, False)
    nvic.leave()
    assert nvic.next() is None
    nvic.leave()
    assert nvic.next() == 30  # its line is still held
    with pytest.raises(NotModelledError, match="0xE000ED08"):
        nvic.write(0xD08, 0, 4)


def test_a_peripheral_without_a_clock_is_an_error() -> None:
    machine = Machine(PLAIN)
    machine._write(0x40000000, None, 0x12C34, 4, 1, None)
    assert "TIM1_CCR1): its clock is off" in str(machine.cpu._error)


def test_the_gantry_obeys_its_equation() -> None:
    """Duties that change now and then, against a numerical solution of report E.1, written out once more."""
    machine = Machine(PLAIN)
    gantry = Gantry(machine, place=(0.3, 0.4))
    steps = [(1000.0, 0.5, -0.25), (21_500.0, -1.0, 0.125), (52_250.0, 0.0, 0.0), (90_000.0, 0.25, 0.25)]
    for step in steps:
        gantry._drive(*step)
    a, b, radius = (3.579e-6, 0.00571, 0.05315), (-1.7165e-6, -0.002739, 0.0), 0.035306

    def slope(_: float, state: np.ndarray, first: float, second: float) -> list[float]:
        x, y = state[:3], state[3:]
        vx, vy = 24 * (first - second), 24 * (-first - second)
        jerk_x = (radius / 2 * vx - (a[1] - b[1]) * x[2] - (a[2] - b[2]) * x[1]) / (a[0] - b[0])
        jerk_y = (radius / 2 * vy - (a[1] + b[1]) * y[2] - (a[2] + b[2]) * y[1]) / (a[0] + b[0])
        return [x[1], x[2], jerk_x, y[1], y[2], jerk_y]

    state = np.array([0.3, 0.0, 0.0, 0.4, 0.0, 0.0])
    for (begin, *duties), (end, *_) in zip(steps, [*steps[1:], (130_000.0,)], strict=True):
        span = (begin * 1e-6, end * 1e-6)
        state = solve_ivp(slope, span, state, "Radau", args=duties, rtol=1e-10, atol=1e-13).y[:, -1]
    assert gantry.place(130_000.0) == pytest.approx((state[0], state[3]), abs=1e-8)
    assert gantry.velocity(130_000.0) == pytest.approx((state[1], state[4]), abs=1e-6)
    first, second = gantry.angles(130_000.0)
    assert (radius * (first - second) / 2, radius * (-first - second) / 2) == pytest.approx((state[0], state[3]))
