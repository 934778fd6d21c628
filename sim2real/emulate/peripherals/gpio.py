"""GPIO ports of 16 pins, each floating, pulled, driven, or assigned to a peripheral."""

from __future__ import annotations

import numpy as np

from puckpilot_env.kernel import kernel

OFFSETS = ("CRL", "CRH", "", "ODR", "BSRR", "BRR")
CRL, CRH, _, ODR, BSRR, BRR = range(6)
PORT_A, PORT_B = 0, 1
NAMES, BASES = ("GPIOA", "GPIOB"), (0x40010800, 0x40010C00)
_FLOATING = 0x44444444
_PULLED = 8  # of a pin's four bits in CRL or CRH; outputs have one of the lower two set, alternate functions bit 3 too

# Masks with a bit for each pin: driven: outputs of ODR; alternate: outputs of a peripheral; held: driven or pulled by
# ODR; high, low: level that ODR gives by driving or pulling.
PORT = np.dtype(
    [
        ("values", np.int64, 6), ("driven", np.int64), ("alternate", np.int64), ("held", np.int64), ("high", np.int64),
        ("low", np.int64),
    ],
    align=True,
)  # fmt: skip


@kernel
def reset_port(port):
    """The state after a reset: every pin floats."""
    for register in range(6):
        port.values[register] = 0
    port.values[CRL] = port.values[CRH] = _FLOATING
    port.driven = port.alternate = port.held = port.high = port.low = 0


@kernel
def read_port(port, register):
    """Read a register; BSRR and BRR read as 0."""
    return 0 if register >= BSRR else port.values[register]


@kernel
def write_port(port, register, value):
    """Write a register; whether that may have changed a pin."""
    values = port.values
    if register >= BSRR:
        before = values[ODR]
        after = (before & ~(value >> 16)) | (value & 0xFFFF) if register == BSRR else before & ~value
        if after == before:
            return False
        values[ODR] = after
    else:
        values[register] = value
        _modes(port)
    port.high, port.low = port.held & values[ODR], port.held & ~values[ODR]
    return True


@kernel
def _modes(port):
    port.driven = port.alternate = port.held = 0
    for pin in range(16):
        mode = port.values[CRH if pin >= 8 else CRL] >> 4 * (pin % 8) & 15
        if mode & 3 and mode & 8:
            port.alternate |= 1 << pin
        elif mode & 3:
            port.driven |= 1 << pin
        if (mode & 3 and not mode & 8) or mode == _PULLED:
            port.held |= 1 << pin
