"""What peripherals have in common: an address, registers with names, and an error for what is not modelled."""

from __future__ import annotations


class NotModelledError(Exception):
    """The program did what this emulator does not know; the message says where and what."""


class Peripheral:
    """Something at `base` with registers. Those without side effects are kept by name in `values`."""

    name = ""
    base = 0
    offsets: tuple[str, ...] = ()  # names of the registers, one every four bytes; "" is not modelled
    start: dict[str, int] = {}  # noqa: RUF012 - values after reset that are not 0
    clocked = True  # whether its clock is on

    def __init__(self) -> None:
        self.values: dict[str, int] = {}
        self.reset()

    def reset(self) -> None:
        """As after a reset."""
        self.values = {name: self.start.get(name, 0) for name in self.offsets if name}

    def read(self, offset: int, size: int) -> int:
        """What the program reads at `base + offset`."""
        return self.get(self._register("read", offset, size))

    def write(self, offset: int, value: int, size: int) -> None:
        """What the program writes there."""
        self.set(self._register("write", offset, size), value)

    def get(self, register: str) -> int:
        """Read a register by name."""
        return self.values[register]

    def set(self, register: str, value: int) -> None:
        """Write a register by name."""
        self.values[register] = value

    def _register(self, act: str, offset: int, size: int) -> str:
        index = offset >> 2
        if size != 4 or offset & 3 or index >= len(self.offsets) or not self.offsets[index]:
            raise self.unknown(act, offset, size)
        if not self.clocked:
            raise NotModelledError(f"{act} of {self.name}_{self.offsets[index]} while its clock is off in RCC")
        return self.offsets[index]

    def unknown(self, act: str, offset: int, size: int) -> NotModelledError:
        """The error for a register that is not modelled."""
        return NotModelledError(f"{act} of {size} bytes at 0x{self.base + offset:08X} ({self.name}): not modelled")
