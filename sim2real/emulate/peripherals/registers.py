"""The base class of peripherals: an address, named registers, and an error for what is not modelled."""

from __future__ import annotations

from typing import ClassVar


def nothing() -> None:
    """What happens after a write whose effects nobody has connected yet."""


class NotModelledError(Exception):
    """The program used a feature that this emulator does not model; the message names it."""


class Peripheral:
    """A peripheral at `base` with registers of 32 bits; `values` holds those without side effects by name."""

    name = ""
    base = 0
    offsets: tuple[str, ...] = ()  # names of the registers, one every four bytes; "" is not modelled
    start: ClassVar[dict[str, int]] = {}  # values after reset that are not 0
    clocked = True  # whether its clock is on

    def __init__(self) -> None:
        self.values: dict[str, int] = {}
        self.reset()

    def reset(self) -> None:
        """Set the state after a reset."""
        self.values = {name: self.start.get(name, 0) for name in self.offsets if name}

    def get(self, register: str) -> int:
        """Read a register by its name."""
        return self.values[register]

    def set(self, register: str, value: int) -> None:
        """Write a register by its name. Raises NotModelledError for a value that is not modelled."""
        self.values[register] = value


def refusal(what: str, address: int, known: tuple[Peripheral, str] | None) -> NotModelledError:
    """The error for an access (`what`) to an address; known: peripheral and register there, None if there is none."""
    name = f" ({known[0].name}_{known[1]})" if known else ""
    why = "its clock is off in RCC" if known and not known[0].clocked else "not modelled"
    return NotModelledError(f"{what} at 0x{address:08X}{name}: {why}")
