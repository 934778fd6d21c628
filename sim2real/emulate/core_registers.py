"""The processor's registers that exceptions save, read and written all at once."""

from __future__ import annotations

import ctypes

from unicorn import arm_const as arm

from sim2real.emulate.unicorn_calls import read_registers, write_registers

LR, PC, PSR, SP, MASK = 5, 6, 7, 8, 9  # places in `CoreRegisters.values`
FRAME = 32  # bytes that an exception pushes on the stack: the first eight of the registers, in their order


class CoreRegisters:
    """R0 to R3, R12, LR, PC, xPSR, SP and PRIMASK as `values`, read from and written to the processor in one call:
    single calls through Unicorn's Python binding take 10 times as long.

    ram: the memory that begins at address `base`, in which the stacks are.
    """

    IDS = (
        arm.UC_ARM_REG_R0, arm.UC_ARM_REG_R1, arm.UC_ARM_REG_R2, arm.UC_ARM_REG_R3, arm.UC_ARM_REG_R12,
        arm.UC_ARM_REG_LR, arm.UC_ARM_REG_PC, arm.UC_ARM_REG_XPSR, arm.UC_ARM_REG_SP, arm.UC_ARM_REG_PRIMASK,
    )  # fmt: skip

    def __init__(self, handle: object, ram: memoryview, base: int) -> None:
        size = len(self.IDS)
        self._ram, self._base = ram, base
        self._handle, self._size = handle, size
        self._ids = (ctypes.c_int * size)(*self.IDS)
        self.values = (ctypes.c_uint32 * size)()
        self._frame = memoryview(self.values).cast("B")[:FRAME]  # the same memory
        start = ctypes.addressof(self.values)
        self._places = (ctypes.c_void_p * size)(*(start + 4 * index for index in range(size)))

    def read(self) -> None:
        """Take the processor's values."""
        read_registers(self._handle, self._ids, self._places, self._size)

    def write(self) -> None:
        """Give the processor these values."""
        write_registers(self._handle, self._ids, self._places, self._size)

    def push(self, stack: int) -> bool:
        """Write the frame of an exception to memory at `stack`; whether there is memory."""
        at = stack - self._base
        if not 0 <= at <= len(self._ram) - FRAME:
            return False
        self._ram[at : at + FRAME] = self._frame
        return True

    def pull(self, stack: int) -> bool:
        """Take the values of a frame at `stack`; whether there is memory."""
        at = stack - self._base
        if not 0 <= at <= len(self._ram) - FRAME:
            return False
        self._frame[:] = self._ram[at : at + FRAME]
        return True
