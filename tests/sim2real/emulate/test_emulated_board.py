"""The board's support code on the emulated chip, with a core that obeys single bytes (plain_core/robot.c)."""

from __future__ import annotations

import shutil
import struct
from pathlib import Path

import pytest

from tests.sim2real.emulate.built import PLAIN, PLAIN_CORE, make, need_compiler

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from firmware import FOLDER
from sim2real.emulate.machine import Machine
from sim2real.emulate.refusals import NotModelledError

BOOTED = 3000  # us: by then the clocks run and the first ticks were made
RXNE = 1 << 5  # of the line's status register: a byte has come
TEXT = b"BCDEFGHIJK"  # no orders
REPORT = ("cause", "boots", "steps", "missed", "lost", "now", "answers", "longest", "heard")


def _machine(**options) -> Machine:
    machine = Machine(PLAIN, **options)
    machine.run(BOOTED)
    assert machine.received() == b""
    return machine


def _report(machine: Machine) -> dict[str, int]:
    """What the core reports of itself."""
    machine.received()
    machine.send(b"r")
    machine.run(machine.now + 3000)
    return dict(zip(REPORT, struct.unpack("<9I", machine.received()), strict=True))


def test_it_starts_at_72_mhz_from_the_crystal_and_steps_each_millisecond() -> None:
    machine = _machine()
    before = _report(machine)
    machine.run(machine.now + 50_000)
    after = _report(machine)
    assert machine.megahertz == 72
    assert after["steps"] - before["steps"] == 53
    assert after["now"] - before["now"] == 53_000
    assert after["missed"] == after["lost"] == 0
    assert after["cause"] == 0x0C  # PORRSTF and PINRSTF, bits 27 and 26 of RCC_CSR


def test_without_a_crystal_it_runs_at_64_mhz_and_all_times_are_the_same() -> None:
    machine = Machine(PLAIN, crystal=False)
    machine.run(10_000)
    assert machine.megahertz == 64
    before = _report(machine)
    machine.send(TEXT)
    machine.run(machine.now + 20_000)
    assert machine.received() == TEXT
    assert _report(machine)["now"] - before["now"] == 23_000


def test_when_the_crystal_stops_the_motors_stop_at_once_and_it_starts_again_without() -> None:
    machine = _machine()
    machine.send(b"p")
    machine.run(10_000)
    machine.crystal_fails()
    machine.run(10_100)
    assert machine.motors.duties == (0.0, 0.0)
    machine.run(60_000)
    assert [cause for _, cause in machine.resets] == ["watchdog"]
    assert machine.megahertz == 64
    assert _report(machine)["lost"] == 0


def test_what_is_sent_comes_back_in_the_time_that_a_megabaud_takes() -> None:
    machine = _machine()
    machine.send(TEXT)
    machine.run(machine.now + 99)
    assert not machine.load("USART1_SR") & RXNE and machine.received() == b""
    machine.run(BOOTED + 10_000)
    assert machine.received() == TEXT
    machine.send(b"l")
    machine.run(machine.now + 5000)
    start, got = None, b""
    machine.send(b"l")
    while len(got) < 380:
        machine.run(machine.now + 10)
        got += machine.received()
        start = machine.now if start is None and len(got) == 191 else start
        assert machine.now < 40_000
    assert got == bytes(range(1, 191)) * 2
    assert start is not None and machine.now - start == pytest.approx(10 * 189, abs=11)


def test_zero_bytes_are_stamped_when_they_come() -> None:
    machine = _machine()
    offset = int(machine.now) - machine.load("TIM2_CNT")  # the counter starts later than the machine
    machine.run(20_000)
    start = machine.now
    machine.send(b"B\0BB\0z")
    machine.run(start + 5000)
    got = machine.received()
    stamps = struct.unpack_from("<2I", got, 5)
    assert got[:5] == b"B\0BB\0"
    assert [stamp + offset - start for stamp in stamps] == pytest.approx([20, 50], abs=1)


def test_stamps_are_right_when_the_counter_has_wrapped() -> None:
    machine = _machine()
    offset = int(machine.now) - machine.load("TIM2_CNT")
    machine.run(65_536 * 3 + offset - 300)  # counter at -300
    start = machine.now
    for _ in range(5):
        machine.send(b"\0z")
        machine.run(machine.now + 3000)
        stamp = struct.unpack_from("<I", machine.received(), 1)[0]
        assert stamp + offset - start == pytest.approx(10, abs=1)
        start = machine.now


def test_motors_are_off_from_the_first_moment_on_and_do_what_the_core_says() -> None:
    machine = _machine()
    assert machine.pwm == [(0.0, 0.0, 0.0)]
    machine.send(b"p")
    machine.run(10_000)
    assert machine.motors.duties == (0.25, -0.5)
    assert machine.pwm_frequency == 20_000
    machine.send(b"0")
    machine.run(12_000)
    assert machine.motors.duties == (0.0, 0.0)


def test_a_reset_takes_the_motors_off_and_starts_anew() -> None:
    machine = _machine()
    boots = _report(machine)["boots"]
    machine.send(b"p")
    machine.run(10_000)
    machine.reset()
    assert machine.motors.duties == (0.0, 0.0)
    machine.run(20_000)
    report = _report(machine)
    assert report["cause"] == 0x04
    assert report["boots"] == (boots * 1664525 + 1013904223) % 2**32
    assert machine.motors.duties == (0.0, 0.0)


def test_a_program_that_hangs_is_reset_by_the_watchdog() -> None:
    machine = _machine(may_hang=True)
    machine.send(b"ph")
    machine.run(60_000)
    ((when, cause),) = machine.resets
    assert cause == "watchdog"
    assert when - BOOTED == pytest.approx(51 * 16 / 40e3 * 1e6, abs=1100)  # since the kick before
    assert _report(machine)["cause"] == 0x24
    assert machine.motors.duties == (0.0, 0.0)


@pytest.mark.parametrize("kilohertz", [30.0, 60.0])
def test_the_watchdog_lets_a_sound_program_live_however_fast_its_oscillator(kilohertz: float) -> None:
    machine = Machine(PLAIN, watchdog_kilohertz=kilohertz)
    machine.run(200_000)
    assert machine.resets == []
    machine.send(b"B")
    machine.run(203_000)
    assert machine.received() == b"B"


def test_a_fault_takes_the_motors_off_at_once_and_the_watchdog_resets() -> None:
    machine = _machine()
    machine.send(b"p")
    machine.run(10_000)
    machine.send(b"f")
    machine.run(12_000)
    assert machine.cpu.faults and machine.motors.duties == (0.0, 0.0)
    assert machine.resets == []
    machine.run(40_000)
    assert [cause for _, cause in machine.resets] == ["watchdog"]


def test_ticks_that_a_slow_step_misses_are_reported_and_no_byte_is_lost() -> None:
    machine = _machine(step_us=1700.0)
    machine.send(TEXT * 20)
    machine.run(60_000)
    assert machine.received() == TEXT * 20
    report = _report(machine)
    assert report["missed"] + report["steps"] == pytest.approx(61, abs=2)
    assert report["steps"] == pytest.approx(61 / 1.7, abs=2)
    assert report["longest"] == 1700
    assert report["lost"] == 0


def test_more_bytes_than_fit_are_counted() -> None:
    machine = _machine(step_us=5500.0)
    machine.send(b"B" * 600)
    machine.run(40_000)
    machine.step_us = 0.0
    machine.run(60_000)
    report = _report(machine)
    assert report["lost"] > 0
    assert report["lost"] + report["heard"] == 601


def test_bytes_without_a_stop_bit_are_counted_and_dropped() -> None:
    machine = _machine()
    machine.disturb(3)
    machine.send(TEXT)
    machine.run(10_000)
    assert machine.received() == TEXT[3:]
    assert _report(machine)["lost"] == 3


def test_the_wrong_baud_rate_is_not_understood() -> None:
    machine = _machine()
    machine.store("USART1_BRR", 76)
    machine.send(TEXT)
    machine.run(10_000)
    machine.store("USART1_BRR", 72)
    assert _report(machine)["lost"] == len(TEXT)


def test_a_register_that_is_not_modelled_is_named() -> None:
    machine = _machine()
    machine.send(b"u")
    with pytest.raises(NotModelledError, match="0x40004400"):
        machine.run(10_000)


def test_counting_instructions_needs_a_timed_machine_and_sees_the_work() -> None:
    with pytest.raises(ValueError, match="timed=True"):
        _machine().instructions(4000)
    machine = _machine(timed=True)
    idle = machine.instructions(13_000)
    machine.send(b"w")
    busy = machine.instructions(30_000)
    assert len(idle) == 10 and max(idle) - min(idle) < 20
    assert max(busy) - max(idle) == pytest.approx(40_000 * 2, rel=0.01)  # a loop of two instructions
    assert _report(machine)["longest"] == pytest.approx((80_000 + idle[0]) * 1.5 / 72, rel=0.01)


@pytest.mark.parametrize("fuzz", range(4))
def test_interrupts_between_any_two_blocks_change_nothing(fuzz: int) -> None:
    machine = Machine(PLAIN, fuzz=fuzz)
    machine.run(4000)
    sent = bytes(value for value in range(256) if chr(value) not in "p0arzdexhfwlu") * 4
    machine.send(sent)
    machine.run(30_000)
    assert machine.received() == sent
    report = _report(machine)
    assert report["lost"] == report["missed"] == 0  # nor is a tick slept through


def test_no_tick_is_slept_through_that_comes_just_as_it_falls_asleep() -> None:
    """A byte wakes it shortly before the tick, at every distance in steps of two cycles."""
    machine = _machine(timed=True)
    for early in range(150):
        machine.run(machine.now + 500)
        machine.run(machine.next_event - 10 - early / 36)
        machine.send(b"B")
        machine.run(machine.now + 2000)
    assert _report(machine)["missed"] == 0


def _bytes_of(seed: int, pieces: int, **options) -> tuple[bytes, list]:
    machine = Machine(PLAIN, seed=seed, **options)
    machine.encoders[0].angle = lambda now: now * 1e-4
    machine.send(b"arBCr")
    got = b""
    for piece in range(pieces):
        machine.run(30_000 * (piece + 1) / pieces)
        got += machine.received()
        if 2 * (piece + 1) == pieces:
            machine.send(b"ra")
    return got, machine.pwm


@pytest.mark.parametrize("options", [{}, {"timed": True}, {"fuzz": 5}])
def test_the_same_seed_gives_the_same_bytes_however_the_run_is_cut(options: dict) -> None:
    once = _bytes_of(1, 2, **options)
    assert once == _bytes_of(1, 2, **options) == _bytes_of(1, 60, **options)
    assert once[0] != _bytes_of(2, 2, **options)[0]  # boots


def test_the_plain_program_rebuilds_byte_for_byte_in_another_folder(tmp_path: Path) -> None:
    need_compiler()
    copy = tmp_path / "elsewhere"
    for name in ("board", "core", "Makefile"):
        (shutil.copytree if (FOLDER / name).is_dir() else shutil.copy2)(FOLDER / name, copy / name)
    shutil.copytree(PLAIN_CORE, copy / "plain")
    make(tmp_path / "out", copy / "plain", copy)
    assert (tmp_path / "out" / "program.elf").read_bytes() == PLAIN.read_bytes()
