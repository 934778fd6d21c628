"""Parts of the emulator against what their data sheets say, worked out by hand, and the gantry against its equation."""

from __future__ import annotations

import gc
import signal
import subprocess
import sys
import weakref
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.sim2real.emulate.built import PLAIN, need_compiler

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from firmware import ELF
from sim2real.emulate.board.board_state import BOARD
from sim2real.emulate.elf import read_elf
from sim2real.emulate.gantry import Gantry
from sim2real.emulate.machine import Machine
from sim2real.emulate.peripherals.as5147 import As5147, exchange
from sim2real.emulate.peripherals.nvic import (
    NO_EXCEPTION,
    enter_exception,
    leave_exception,
    next_exception,
    reset_nvic,
    set_line,
    write_nvic,
)
from sim2real.emulate.refusals import TEXTS, WRITE, NotModelledError
from sim2real.emulate.timeline import (
    BYTE_COMES,
    NEVER,
    PIECE_SENT,
    TICK_DUE,
    TIMELINE,
    WATCHDOG_DUE,
    clear_timeline,
    drop,
    next_kind,
    next_tick,
    schedule,
)

ANGLE, NOTHING, ERRORS, HEALTH, BAD_PARITY, WRITING = 0xFFFF, 0xC000, 0x4001, 0xFFFC, 0x7FFF, 0x3FFF


def _exchange(encoder: As5147, command: int) -> int:
    return exchange(encoder.state, command, 0)


def _answer(encoder: As5147, command: int) -> int:
    _exchange(encoder, command)
    return _exchange(encoder, NOTHING)


def _quarter() -> As5147:
    encoder = As5147()
    encoder.angle = lambda now: 2 * np.pi * (0.25 + 1e-6) + 20 * np.pi
    return encoder


def test_an_encoder_answers_in_the_next_frame_with_even_parity() -> None:
    encoder = _quarter()
    assert _exchange(encoder, ANGLE) == 0
    assert _exchange(encoder, HEALTH) == 0b1001_0000_0000_0000  # 4096 steps have one bit set: parity makes it two
    assert _exchange(encoder, NOTHING) == 0b0000_0001_1000_0000  # loops finished, gain 128
    encoder.angle = lambda now: -1e-9
    assert _answer(encoder, ANGLE) == 0b0011_1111_1111_1111


@pytest.mark.parametrize(("wrong", "says"), [(BAD_PARITY, 4), (WRITING, 2), (0x4123 | 0x8000, 2)])
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
    timeline = np.zeros(1, TIMELINE)[0]
    clear_timeline(timeline)
    assert next_tick(timeline) == NEVER
    schedule(timeline, TICK_DUE, 10)
    schedule(timeline, PIECE_SENT, 20)
    schedule(timeline, WATCHDOG_DUE, 15)
    schedule(timeline, BYTE_COMES, 15)
    drop(timeline, TICK_DUE)
    seen = []
    while (tick := next_tick(timeline)) != NEVER:
        seen.append((tick, next_kind(timeline)))
        timeline["now"] = tick
        drop(timeline, seen[-1][1])
    assert seen == [(15, WATCHDOG_DUE), (15, BYTE_COMES), (20, PIECE_SENT)]
    schedule(timeline, TICK_DUE, 3)
    assert next_tick(timeline) == 20  # at once, for that is past


def test_the_more_urgent_exception_is_served_and_interrupts_the_other() -> None:
    board = np.zeros(1, BOARD)[0]
    nvic = board["nvic"]
    reset_nvic(nvic)
    write_nvic(board, 0x100, 1 << 14, 4)
    write_nvic(board, 0x104, 1 << 5, 4)
    write_nvic(board, 0x400 + 14, 0x4F, 1)
    set_line(nvic, 14, True)
    assert next_exception(nvic) == 30
    enter_exception(nvic, 30)
    assert next_exception(nvic) == NO_EXCEPTION
    set_line(nvic, 37, True)
    assert next_exception(nvic) == 53
    enter_exception(nvic, 53)
    set_line(nvic, 37, False)
    leave_exception(nvic)
    assert next_exception(nvic) == NO_EXCEPTION
    leave_exception(nvic)
    assert next_exception(nvic) == 30  # its line is still held
    write_nvic(board, 0xD08, 0, 4)
    refusal = board["refusal"]
    assert TEXTS[refusal["number"]] == TEXTS[WRITE] and refusal["value"] == 0xE000ED08


def test_a_peripheral_without_a_clock_is_an_error() -> None:
    machine = Machine(PLAIN)
    with pytest.raises(NotModelledError, match=r"TIM1_CCR1\): its clock is off"):
        machine.store("TIM1_CCR1", 1)


@pytest.mark.parametrize(
    ("register", "value", "says"),
    [
        ("SysTick_CTRL", 1, "CTRL = 1: expected 0, or 7"),
        ("RCC_CFGR", 3, "expected HSI or PLL"),
        ("RCC_CFGR", 2, "a PLL that is not ready"),
        ("IWDG_PR", 1, "while locked"),
        ("TIM1_CCER", 1, "expected CC1NE and CC2NE alone"),
    ],
)
def test_a_value_that_is_not_modelled_is_named_and_the_next_is_not_blamed_for_it(
    register: str, value: int, says: str
) -> None:
    machine = Machine(PLAIN)
    machine.store("RCC_APB2ENR", 1 << 11)
    with pytest.raises(NotModelledError, match=says):
        machine.store(register, value)
    assert machine.load(register) != value
    machine.store("FLASH_ACR", 2)
    assert machine.load("FLASH_ACR") == 2


def test_an_error_of_a_shaft_comes_out_of_the_run_and_the_board_runs_on() -> None:
    machine = Machine(ELF)
    machine.run(20_000)

    def broken(now: float) -> float:
        raise OSError("no shaft")

    machine.encoders[1].angle = broken
    with pytest.raises(OSError, match="no shaft"):
        machine.run(30_000)
    assert machine.now < 22_000
    machine.encoders[1].angle = lambda now: 0.5
    machine.run(30_000)
    assert machine.now == 30_000 and machine.received()


@pytest.mark.parametrize("angle", [float("nan"), float("inf"), None])
def test_a_shaft_without_an_angle_is_an_error(angle: float) -> None:
    machine = Machine(ELF)
    machine.encoders[0].angle = lambda now: angle
    with pytest.raises((ValueError, TypeError)):
        machine.run(30_000)


def test_an_interrupt_that_comes_as_a_shaft_is_asked_ends_the_run() -> None:
    """Python raises it where it next runs, which is in the call from compiled code; also in a shell's background job,
    which ignores interrupts by itself."""
    machine, before = Machine(ELF), sys.unraisablehook
    heeded = signal.signal(signal.SIGINT, signal.default_int_handler)

    def interrupt(now: float) -> float:
        signal.raise_signal(signal.SIGINT)
        return 0.0

    machine.encoders[0].angle = interrupt
    try:
        for _ in range(10):
            with pytest.raises(KeyboardInterrupt):
                machine.run(machine.now + 30_000)
    finally:
        signal.signal(signal.SIGINT, heeded)
    assert sys.unraisablehook == before


def test_an_error_of_who_listens_to_the_motors_comes_out_of_a_reset() -> None:
    machine = Machine(PLAIN)
    machine.run(3000)
    machine.send(b"p")
    machine.run(10_000)

    def broken(*_: float) -> None:
        raise OSError("no motor")

    machine.motors.listeners.append(broken)
    with pytest.raises(OSError, match="no motor"):
        machine.reset()
    machine.motors.listeners.clear()
    machine.run(20_000)
    assert machine.motors.duties == (0.0, 0.0)


def test_more_bytes_than_the_line_holds_all_come() -> None:
    """They are a second and a half on the line, and more than two come back."""
    machine = Machine(PLAIN)
    machine.run(3000)
    sent = b"BCDEFGHIJK" * 15_000
    machine.send(sent)
    machine.run(1_600_000)
    assert machine.received() == sent


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


def test_a_closed_machine_is_freed_at_once_and_does_not_run() -> None:
    machine = Machine(PLAIN)
    machine.run(1000)
    freed = weakref.ref(machine.cpu.uc)
    gc.disable()
    try:
        machine.close()
        machine.close()
        assert freed() is None
    finally:
        gc.enable()
    with pytest.raises(ValueError, match="closed"):
        machine.run(2000)
