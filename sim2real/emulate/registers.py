"""What peripherals have in common: an address, registers with names, and an error for what is not modelled."""

from __future__ import annotations

from typing import ClassVar


class NotModelledError(Exception):
    """The program did what this emulator does not know; the message says where and what."""


class Peripheral:
    """Something at `base` with registers of 32 bits; those without side effects are kept by name in `values`."""

    name = ""
    base = 0
    offsets: tuple[str, ...] = ()  # names of the registers, one every four bytes; "" is not modelled
    start: ClassVar[dict[str, int]] = {}  # values after reset that are not 0
    clocked = True  # whether its clock is on

    def __init__(self) -> None:
        self.values: dict[str, int] = {}
        self.reset()

    def reset(self) -> None:
        """As after a reset."""
        self.values = {name: self.start.get(name, 0) for name in self.offsets if name}

    def get(self, register: str) -> int:
        """What the program reads."""
        return self.values[register]

    def set(self, register: str, value: int) -> None:
        """What the program writes."""
        self.values[register] = value
