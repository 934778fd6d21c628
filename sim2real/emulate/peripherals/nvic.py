"""The interrupt controller NVIC, with the priorities of system exceptions (ARMv7-M manual, B1.5 and B3.4)."""

from __future__ import annotations

from sim2real.emulate.peripherals.registers import NotModelledError

NMI, HARD_FAULT, SYSTICK = 2, 3, 15
INTERRUPT = 16  # exception number of interrupt 0
_HIGHEST = {NMI: -2, HARD_FAULT: -1}
_ENABLE, _DISABLE, _PRIORITY, _SYSTEM_PRIORITY = 0x100, 0x180, 0x400, 0xD18
_INTERRUPTS = 43


class Nvic:
    """Pending, enabled and active exceptions; only the upper 4 bits of a priority count, as on the STM32F1."""

    base = 0xE000E000

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Set the state after a reset: no interrupt enabled, pending or active."""
        self.enabled = {NMI, HARD_FAULT, SYSTICK}
        self.pending: set[int] = set()
        self.active: list[int] = []
        self.high: set[int] = set()  # interrupts whose line is active
        self.priority: dict[int, int] = dict(_HIGHEST)

    def line(self, interrupt: int, high: bool) -> None:
        """Set the level of a peripheral's interrupt line."""
        number = INTERRUPT + interrupt
        if high and number not in self.high:
            self.high.add(number)
            self.pending.add(number)
        elif not high:
            self.high.discard(number)

    def level(self, number: int) -> int:
        """The priority of an exception; lower is more urgent."""
        return self.priority.get(number, 0)

    def next(self) -> int | None:
        """The pending exception that preempts the active ones, regardless of masks; None if there is none."""
        ready = self.pending & self.enabled
        if not ready:
            return None
        if len(ready) > 1:
            level, number = min((self.level(number), number) for number in ready)
        else:
            (number,) = ready
            level = self.level(number)
        for one in self.active:
            if self.level(one) <= level:
                return None
        return number

    def enter(self, number: int) -> None:
        """Note that an exception is entered."""
        self.pending.discard(number)
        self.active.append(number)

    def leave(self) -> None:
        """Note the return from the innermost exception; it becomes pending again if its line is still active."""
        number = self.active.pop()
        if number in self.high:
            self.pending.add(number)

    def read(self, offset: int, size: int) -> int:
        """Read a register. Raises NotModelledError for one that is not modelled."""
        if _ENABLE <= offset < _ENABLE + 8:
            first = INTERRUPT + (offset - _ENABLE) * 8
            return sum(1 << bit for bit in range(32) if first + bit in self.enabled)
        if size == 1 and (number := self._byte(offset)) is not None:
            return self.level(number)
        raise NotModelledError(f"read of {size} bytes at 0x{self.base + offset:08X} (NVIC): not modelled")

    def write(self, offset: int, value: int, size: int) -> None:
        """Write a register. Raises NotModelledError for one that is not modelled."""
        if size == 4 and (_ENABLE <= offset < _ENABLE + 8 or _DISABLE <= offset < _DISABLE + 8):
            base = _ENABLE if offset < _DISABLE else _DISABLE
            named = {INTERRUPT + (offset - base) * 8 + bit for bit in range(32) if value >> bit & 1}
            self.enabled = self.enabled | named if base == _ENABLE else self.enabled - named
        elif size == 1 and (number := self._byte(offset)) is not None:
            self.priority[number] = value & 0xF0
        else:
            raise NotModelledError(f"write of {size} bytes at 0x{self.base + offset:08X} (NVIC): not modelled")

    @staticmethod
    def _byte(offset: int) -> int | None:
        """The exception whose priority is at `offset`; None if there is none."""
        if _PRIORITY <= offset < _PRIORITY + _INTERRUPTS:
            return INTERRUPT + offset - _PRIORITY
        if _SYSTEM_PRIORITY <= offset < _SYSTEM_PRIORITY + 12:
            return 4 + offset - _SYSTEM_PRIORITY
        return None
