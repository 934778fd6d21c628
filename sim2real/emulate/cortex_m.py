"""A Cortex-M3 in Unicorn, with the board's state behind its memory, its registers and its hooks."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np
import unicorn
from unicorn import arm_const as arm
from unicorn.unicorn_py3.unicorn import HOOK_CODE_CFUNC, Uc, UcError, uclib

from sim2real.emulate.board import bus, callbacks
from sim2real.emulate.board.core import PC, SAVED
from sim2real.emulate.elf import Elf
from sim2real.emulate.memory import FLASH, FLASH_SIZE, RAM, RAM_SIZE
from sim2real.emulate.unicorn_calls import address_of

_WFE, _NOP, _CPSIE = b"\x20\xbf", b"\x00\xbf", b"\x62\xb6"
_EVERYWHERE = 1, 0  # of a hook


class CortexM:
    """The processor.

    elf: the program; boards: an array of one `board_state.BOARD`, which is filled; failed: called with an error of a
    function that was given to `at`.
    """

    def __init__(self, elf: Elf, boards: np.ndarray, failed: Callable[[BaseException], None]) -> None:
        self._boards, self._core, self._failed = boards, boards[0]["core"], failed
        self._kept: list[object] = []  # callbacks, as long as Unicorn calls them
        self.uc = Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS, arm.UC_CPU_ARM_CORTEX_M3)
        self._map()
        self._name_registers()
        for segment in elf.segments:
            begin = segment.address - FLASH
            self.flash[begin : begin + len(segment.data)] = np.frombuffer(segment.data, np.uint8)
            if segment.executable:
                self._watch(segment.address, segment.data)
        self._hook(unicorn.UC_HOOK_INTR, callbacks.interrupted.address, *_EVERYWHERE)

    def _map(self) -> None:
        memory = self._boards["memory"]
        self.flash, self.ram = memory["flash"][0], memory["ram"][0]
        read, write, execute = unicorn.UC_PROT_READ, unicorn.UC_PROT_WRITE, unicorn.UC_PROT_EXEC
        self.uc.mem_map_ptr(FLASH, FLASH_SIZE, read | execute, self.flash.ctypes.data)
        self.uc.mem_map_ptr(RAM, RAM_SIZE, read | write, self.ram.ctypes.data)
        for base, size, reads, writes in (
            (bus.PERIPHERALS, bus.PERIPHERALS_SIZE, callbacks.read_peripheral, callbacks.write_peripheral),
            (bus.SYSTEM, bus.SYSTEM_SIZE, callbacks.read_system, callbacks.write_system),
        ):
            state, pointer = self._boards.ctypes.data, ctypes.c_void_p
            answers = pointer(reads.address), pointer(state), pointer(writes.address), pointer(state)
            _check(uclib.uc_mmio_map(self.uc._uch, ctypes.c_uint64(base), ctypes.c_size_t(size), *answers))

    def _name_registers(self) -> None:
        """Tell compiled code where Unicorn is, and which of its registers go where."""
        core = self._boards["core"]
        self._core["unicorn"] = address_of(self.uc._uch)
        self._core["ids"] = SAVED
        first = core["registers"][0].ctypes.data
        self._core["places"] = [first + 4 * index for index in range(len(SAVED))]
        self._core["ids_at"], self._core["places_at"] = core["ids"].ctypes.data, core["places"].ctypes.data
        self._core["mask_id"] = arm.UC_ARM_REG_PRIMASK
        self._core["mask_at"] = core["mask"].ctypes.data

    def _watch(self, address: int, code: bytes) -> None:
        """Hook the instructions that Unicorn does not handle: check for a pending interrupt after each `cpsie i`, and
        replace each `wfe` by a hooked `nop`."""
        for at in range(0, len(code) - 1, 2):
            word = code[at : at + 2]
            if word == _CPSIE:
                self.call_at(address + at + 2, callbacks.unmasked)
            elif word == _WFE:
                self.flash[address + at - FLASH : address + at + 2 - FLASH] = np.frombuffer(_NOP, np.uint8)
                self.call_at(address + at, callbacks.waits_for_event)

    def _hook(self, kind: int, function: int, begin: int, end: int) -> None:
        """Have the function at an address called; through Unicorn's binding each call takes ten times as long."""
        handle, state = ctypes.byref(ctypes.c_size_t()), ctypes.c_void_p(self._boards.ctypes.data)
        where = ctypes.c_uint64(begin), ctypes.c_uint64(end)
        _check(uclib.uc_hook_add(self.uc._uch, handle, kind, ctypes.c_void_p(function), state, *where))

    def close(self) -> None:
        """Free what Unicorn holds, a gigabyte of addresses: the processor cannot run any more."""
        del self.uc

    def call_at(self, address: int, callback: Any) -> None:
        """Have a compiled callback called whenever the program reaches `address`."""
        self._hook(unicorn.UC_HOOK_CODE, callback.address, address, address)

    def call_at_blocks(self, callback: Any) -> None:
        """Have a compiled callback called whenever a block of code begins."""
        self._hook(unicorn.UC_HOOK_BLOCK, callback.address, *_EVERYWHERE)

    def at(self, address: int, what: Callable[[], None]) -> None:
        """Call `what` whenever the program reaches `address`; if it stops the processor, it is called again on
        resumption."""

        def reached(*_: object) -> None:
            try:
                what()
            except BaseException as error:  # Unicorn's code is between here and who handles it
                self._failed(error)

        callback = HOOK_CODE_CFUNC(reached)
        self._kept.append(callback)
        self._hook(unicorn.UC_HOOK_CODE, address_of(callback), address, address)

    @property
    def faults(self) -> list[tuple[int, str]]:
        """Address and reason of each fault."""
        noted = self._core["faults"][: self._core["fault_count"]]
        return [(int(at), f"exception {why}" if why >= 0 else str(UcError(-why))) for at, why in noted]

    @property
    def program_counter(self) -> int:
        """The address of the next instruction, while the processor does not run."""
        return int(self._core["registers"][PC])


def _check(status: int) -> None:
    if status:
        raise UcError(status)
