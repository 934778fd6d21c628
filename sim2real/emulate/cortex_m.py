"""A Cortex-M3 in Unicorn, with entry to and return from exceptions (ARMv7-M manual, B1.5)."""

from __future__ import annotations

import ctypes
import struct
from collections.abc import Callable
from functools import partial
from typing import Any

import unicorn
from unicorn import arm_const as arm
from unicorn.unicorn_py3.unicorn import (
    HOOK_CODE_CFUNC,
    HOOK_INTR_CFUNC,
    MMIO_READ_CFUNC,
    MMIO_WRITE_CFUNC,
    Uc,
    UcError,
    uclib,
)

from sim2real.emulate.core_registers import FRAME, LR, MASK, PC, PSR, SP, CoreRegisters
from sim2real.emulate.elf import Elf
from sim2real.emulate.peripherals.nvic import HARD_FAULT, Nvic
from sim2real.emulate.unicorn_calls import emu_start, emu_stop

FLASH, FLASH_SIZE = 0x08000000, 0x10000
RAM, RAM_SIZE = 0x20000000, 0x5000
_PERIPHERALS, _PERIPHERALS_SIZE = 0x40000000, 0x24000
_SYSTEM, _SYSTEM_SIZE = 0xE000E000, 0x1000
_NOWHERE = 0xFFFFFFFE  # an address that is never reached
_RETURN_TO_THREAD, _RETURN_TO_HANDLER = 0xFFFFFFF9, 0xFFFFFFF1
_EXCEPTION_RETURN = 8  # Unicorn's number for a jump to one of these
_WFI, _WFE, _NOP, _CPSIE = b"\x30\xbf", b"\x20\xbf", b"\x00\xbf", b"\x62\xb6"
_THUMB = 1 << 24


class CortexM:
    """The processor.

    elf: the program; nvic: the interrupt controller; read, write: accesses to peripherals, in the form of Unicorn's
    callbacks `(base, handle, offset, size, data)` and `(base, handle, offset, size, value, data)`, which do not raise;
    goes_on: whether the program runs on after the return from an exception, with nothing else to do first.
    """

    def __init__(
        self,
        elf: Elf,
        nvic: Nvic,
        read: Callable[..., int],
        write: Callable[..., None],
        goes_on: Callable[[], bool],
    ) -> None:
        self.nvic, self._goes_on = nvic, goes_on
        self.faults: list[tuple[int, str]] = []  # address and reason of each fault
        self.asleep = self.locked = False
        self._running = self._event = False
        self._why = ""
        self._error: BaseException | None = None
        self._waits: set[int] = set()  # addresses of WFI
        self.uc = uc = Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS, arm.UC_CPU_ARM_CORTEX_M3)
        uc.mem_map(FLASH, FLASH_SIZE, unicorn.UC_PROT_READ | unicorn.UC_PROT_EXEC)
        self._memory = (ctypes.c_char * RAM_SIZE)()
        uc.mem_map_ptr(RAM, RAM_SIZE, unicorn.UC_PROT_READ | unicorn.UC_PROT_WRITE, ctypes.addressof(self._memory))
        self.ram = memoryview(self._memory).cast("B")  # from address RAM on
        self._callbacks: list[object] = []  # to be kept as long as Unicorn calls them
        for base, size in ((_PERIPHERALS, _PERIPHERALS_SIZE), (_SYSTEM, _SYSTEM_SIZE)):
            self._map(base, size, MMIO_READ_CFUNC(partial(read, base)), MMIO_WRITE_CFUNC(partial(write, base)))
        self._add_hook(unicorn.UC_HOOK_INTR, HOOK_INTR_CFUNC(self._interrupted), 1, 0)  # at every address
        for segment in elf.segments:
            uc.mem_write(segment.address, segment.data)
            if segment.executable:
                self._watch(segment.address, segment.data)
        self._registers = CoreRegisters(uc._uch, self.ram, RAM)
        self._registers.read()
        self._state = self._registers.values  # while the processor does not run

    def _map(self, base: int, size: int, read: object, write: object) -> None:
        """Map peripherals, whose accesses are most of the work: through Unicorn's binding each takes twice as long."""
        self._callbacks += [read, write]
        if status := uclib.uc_mmio_map(self.uc._uch, base, size, read, None, write, None):
            raise UcError(status)

    def _add_hook(self, kind: int, callback: Any, begin: int, end: int) -> None:
        """Have a callback called that does not raise; through Unicorn's binding each call takes twice as long."""
        self._callbacks.append(callback)
        where = ctypes.c_uint64(begin), ctypes.c_uint64(end)
        if status := uclib.uc_hook_add(
            self.uc._uch, ctypes.byref(ctypes.c_size_t()), kind, ctypes.cast(callback, ctypes.c_void_p), None, *where
        ):
            raise UcError(status)

    def _watch(self, address: int, code: bytes) -> None:
        """Hook the instructions that Unicorn does not handle: check for a pending interrupt after each `cpsie i`,
        replace each `wfe` by a hooked `nop`, and note the addresses of `wfi`."""
        for at in range(0, len(code) - 1, 2):
            word = code[at : at + 2]
            if word == _CPSIE:
                self._hook(address + at + 2, self._unmasked)
            elif word == _WFI:
                self._waits.add(address + at)
            elif word == _WFE:
                self.uc.mem_write(address + at, _NOP)
                self._hook(address + at, self._wait_for_event)

    def _unmasked(self) -> None:
        if self.nvic.pending and self.deliverable() is not None:
            self.stop()

    def _wait_for_event(self) -> None:
        if self._event:
            self._event = False
        else:
            self._why = "event"
            emu_stop(self.uc._uch)

    def _interrupted(self, _: object, number: int, __: object) -> None:
        """Handle an exception that Unicorn raised. A return from an exception is made at once, and the program goes on
        if nothing has to be done first: that takes less time than to stop and to start again."""
        try:
            if number == _EXCEPTION_RETURN:
                self._registers.read()
                self._leave()
                if not (self._why or self.locked) and self._goes_on():
                    self._registers.write()
                    return
            self._why = "return" if number == _EXCEPTION_RETURN else f"fault: exception {number}"
            emu_stop(self.uc._uch)
        except BaseException as error:  # Unicorn's code is between here and who handles it
            self.fail(error)

    def at(self, address: int, what: Callable[[], None]) -> None:
        """Call `what` whenever the program reaches `address`; if it calls `stop`, it is called again on resumption."""
        self._hook(address, what)

    def _hook(self, address: int, what: Callable[[], None]) -> None:
        def reached(*_: object) -> None:
            try:
                what()
            except BaseException as error:
                self.fail(error)

        self._add_hook(unicorn.UC_HOOK_CODE, HOOK_CODE_CFUNC(reached), address, address)

    def reset(self) -> None:
        """Restart at the reset vector; memory keeps its contents."""
        stack, start, *others = struct.unpack("<59I", self.uc.mem_read(FLASH, 4 * 59))
        self._vectors = [0, 0, *(vector & ~1 for vector in others)]
        self._state[:] = [0, 0, 0, 0, 0, 0xFFFFFFFF, start & ~1, _THUMB, stack, 0]
        self.nvic.reset()
        self.asleep = self.locked = self._event = False

    def memory(self, address: int, size: int) -> bytes:
        """The bytes of memory at an address."""
        at = address - RAM
        return bytes(self.ram[at : at + size] if at >= 0 else self.uc.mem_read(address, size))

    def stop(self) -> None:
        """Make `run` return before the next instruction. During a peripheral's read, the read is repeated on
        resumption."""
        if self._running:
            self._why = self._why or "stop"
            emu_stop(self.uc._uch)

    def fail(self, error: BaseException) -> None:
        """Make `run` raise this error."""
        self._error = error
        emu_stop(self.uc._uch)

    def deliverable(self) -> int | None:
        """The number of the exception that has to be entered now; None if there is none."""
        if not self.nvic.pending:
            return None
        number = self.nvic.next()
        if number is None or self.locked or (number > HARD_FAULT and self._masked):
            return None
        return number

    @property
    def woken(self) -> bool:
        """Whether a pending exception, masked or not, wakes the processor."""
        return bool(self.nvic.pending) and not self.locked and self._why != "event" and self.nvic.next() is not None

    @property
    def _masked(self) -> bool:
        return bool((self.uc.reg_read(arm.UC_ARM_REG_PRIMASK) if self._running else self._state[MASK]) & 1)

    @property
    def program_counter(self) -> int:
        """The address of the next instruction."""
        return self._state[PC]

    def run(self, most: int) -> str:
        """Run, and return why it ended: "sleep" (WFI), "event" (WFE), "stop", "slice" (after `most` instructions; 0 is
        no limit), "return" (from an exception), or "fault: ..."."""
        self._why, self._running = "", True
        self._registers.write()
        status = emu_start(self.uc._uch, self._state[PC] | 1, _NOWHERE, 0, most)
        self._running = False
        if status:
            self._why = f"fault: {UcError(status)}"
        if self._error is not None:
            error, self._error = self._error, None
            self._registers.read()  # who catches it may run on
            raise error
        if self._why == "return":
            return self._why
        self._registers.read()
        if self._why == "event":
            self._state[PC] += 2
            self.asleep = True
        elif self._why.startswith("fault"):
            self._fault(self._why)
        elif not self._why:
            self.asleep = self._state[PC] - 2 in self._waits
            self._why = "sleep" if self.asleep else "slice"
        return self._why

    def enter(self, number: int) -> None:
        """Enter an exception: push the frame on the stack and continue at its vector."""
        values = self._state
        odd = values[SP] >> 2 & 1
        stack, before = values[SP] - FRAME - 4 * odd, values[PSR]
        values[PSR] = before | odd << 9
        if not self._registers.push(stack):
            values[PSR] = before
            self.locked = self.asleep = True  # no stack left: lockup
            return
        values[SP], values[PC] = stack, self._vectors[number]
        values[LR] = _RETURN_TO_HANDLER if self.nvic.active else _RETURN_TO_THREAD
        values[PSR] = before & 0xF8000000 | _THUMB | number
        self.nvic.enter(number)
        self._event = not self.asleep  # otherwise the loop around WFE would only run once more
        self.asleep = False

    def _leave(self) -> None:
        values = self._state
        stack = values[SP]
        self.nvic.leave()
        if not self._registers.pull(stack):
            self.locked = self.asleep = True
            return
        odd = values[PSR] >> 9 & 1
        values[PSR] &= ~(1 << 9)
        values[SP] = stack + FRAME + 4 * odd

    def _fault(self, why: str) -> None:
        self.faults.append((self.program_counter, why))
        if any(self.nvic.level(number) < 0 for number in self.nvic.active):
            self.locked = self.asleep = True  # a fault in the fault handler: lockup
        else:
            self.enter(HARD_FAULT)
