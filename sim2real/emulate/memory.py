"""Flash and RAM: bytes that processor and kernels share."""

from __future__ import annotations

import numpy as np

from puckpilot_env.kernel import inlined_kernel

FLASH, FLASH_SIZE = 0x08000000, 0x10000
RAM, RAM_SIZE = 0x20000000, 0x5000
MEMORY = np.dtype([("flash", np.uint8, FLASH_SIZE), ("ram", np.uint8, RAM_SIZE)], align=True)


@inlined_kernel
def is_memory(address, size):
    """Whether there is memory of so many bytes at an address."""
    in_ram = RAM <= address <= RAM + RAM_SIZE - size
    return in_ram or FLASH <= address <= FLASH + FLASH_SIZE - size


@inlined_kernel
def byte_at(board, address):
    """The byte at an address, 0 where there is no memory."""
    if RAM <= address < RAM + RAM_SIZE:
        return np.int64(board.memory.ram[address - RAM])
    if FLASH <= address < FLASH + FLASH_SIZE:
        return np.int64(board.memory.flash[address - FLASH])
    return 0
