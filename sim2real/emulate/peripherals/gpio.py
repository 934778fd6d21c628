"""GPIO ports of 16 pins, each floating, pulled, driven, or assigned to a peripheral."""

from __future__ import annotations

from typing import ClassVar

from sim2real.emulate.peripherals.registers import Peripheral, nothing

_PULLED = 8  # of a pin's four bits in CRL or CRH; outputs have one of the lower two set, alternate functions bit 3 too


class GpioPort(Peripheral):
    """GPIOA or GPIOB; `changed` is called after each write that changes a pin.

    Masks with a bit for each pin: driven: outputs of ODR; alternate: outputs of a peripheral; high, low: level that ODR
    gives by driving or pulling.
    """

    offsets = ("CRL", "CRH", "", "ODR", "BSRR", "BRR")
    start: ClassVar[dict[str, int]] = {"CRL": 0x44444444, "CRH": 0x44444444}

    def __init__(self, letter: str, base: int) -> None:
        self.name, self.base, self.changed = f"GPIO{letter}", base, nothing
        super().__init__()

    def reset(self) -> None:
        """As after a reset: every pin floats."""
        super().reset()
        self._modes()
        self.high = self.low = 0

    def set(self, register: str, value: int) -> None:
        """See `Peripheral`."""
        values = self.values
        if register == "BSRR" or register == "BRR":
            before = values["ODR"]
            after = before & ~(value >> 16) | value & 0xFFFF if register == "BSRR" else before & ~value
            if after == before:
                return
            values["ODR"] = after
        else:
            values[register] = value
            self._modes()
        held = self._held
        self.high, self.low = held & values["ODR"], held & ~values["ODR"]
        self.changed()

    def get(self, register: str) -> int:
        """BSRR and BRR read as 0."""
        return 0 if register in ("BSRR", "BRR") else self.values[register]

    def _modes(self) -> None:
        config = self.values["CRH"] << 32 | self.values["CRL"]
        modes = [config >> 4 * pin & 15 for pin in range(16)]
        self.driven = sum(1 << pin for pin, mode in enumerate(modes) if mode & 3 and not mode & 8)
        self.alternate = sum(1 << pin for pin, mode in enumerate(modes) if mode & 3 and mode & 8)
        self._held = self.driven | sum(1 << pin for pin, mode in enumerate(modes) if mode == _PULLED)
