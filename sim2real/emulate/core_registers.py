"""The processor's registers that exceptions save, read and written all at once."""

from __future__ import annotations

import ctypes

from unicorn import arm_const as arm
from unicorn.unicorn_py3.unicorn import uclib

LR, PC, PSR, SP, MASK = 5, 6, 7, 8, 9  # places in `CoreRegisters.IDS`


class CoreRegisters:
    """R0 to R3, R12, LR, PC, xPSR, SP and PRIMASK, read and written in one call: single calls through Unicorn's Python
    binding take 10 times as long."""

    IDS = (
        arm.UC_ARM_REG_R0, arm.UC_ARM_REG_R1, arm.UC_ARM_REG_R2, arm.UC_ARM_REG_R3, arm.UC_ARM_REG_R12,
        arm.UC_ARM_REG_LR, arm.UC_ARM_REG_PC, arm.UC_ARM_REG_XPSR, arm.UC_ARM_REG_SP, arm.UC_ARM_REG_PRIMASK,
    )  # fmt: skip

    def __init__(self, handle: object) -> None:
        size = len(self.IDS)
        self._handle, self._size = handle, size
        self._ids = (ctypes.c_int * size)(*self.IDS)
        self._values = (ctypes.c_uint32 * size)()
        start = ctypes.addressof(self._values)
        self._places = (ctypes.c_void_p * size)(*(start + 4 * index for index in range(size)))

    def read(self) -> list[int]:
        """Their values, in the order of `IDS`."""
        uclib.uc_reg_read_batch(self._handle, self._ids, self._places, self._size)
        return self._values[:]

    def write(self, values: list[int]) -> None:
        """Set them to values in the order of `IDS`."""
        self._values[:] = values
        uclib.uc_reg_write_batch(self._handle, self._ids, self._places, self._size)
