"""Ports of 16 pins, each floating, pulled, driven, or lent to a peripheral."""

from __future__ import annotations

from collections.abc import Callable

from sim2real.emulate.registers import Peripheral


class Port(Peripheral):
    """GPIOA or GPIOB; `changed` is called after each write."""

    offsets = ("CRL", "CRH", "", "ODR", "BSRR", "BRR")
    start = {"CRL": 0x44444444, "CRH": 0x44444444}  # noqa: RUF012

    def __init__(self, letter: str, base: int, changed: Callable[[], None]) -> None:
        self.name, self.base, self._changed = f"GPIO{letter}", base, changed
        super().__init__()

    def set(self, register: str, value: int) -> None:
        """See `Peripheral`."""
        values = self.values
        if register == "BSRR":
            values["ODR"] = values["ODR"] & ~(value >> 16) | value & 0xFFFF
        elif register == "BRR":
            values["ODR"] &= ~value
        else:
            values[register] = value
        self._changed()

    def get(self, register: str) -> int:
        """BSRR and BRR read as 0."""
        return 0 if register in ("BSRR", "BRR") else self.values[register]

    def _mode(self, pin: int) -> int:
        return self.values["CRL" if pin < 8 else "CRH"] >> 4 * (pin & 7) & 15

    def driven(self, pin: int) -> bool:
        """Whether the pin is an output that ODR rules."""
        return bool(self._mode(pin) & 3) and not self._mode(pin) & 8

    def lent(self, pin: int) -> bool:
        """Whether the pin is a peripheral's output."""
        return bool(self._mode(pin) & 3) and bool(self._mode(pin) & 8)

    def level(self, pin: int) -> bool | None:
        """High or low, as ODR has it by driving or pulling; None if it floats or is lent."""
        if self.driven(pin) or self._mode(pin) == 8:
            return bool(self.values["ODR"] >> pin & 1)
        return None
