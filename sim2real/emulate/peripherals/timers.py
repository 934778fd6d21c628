"""TIM1, which generates the PWM, and TIM2, which counts microseconds."""

from __future__ import annotations

from typing import ClassVar

from sim2real.emulate.peripherals.rcc import Rcc
from sim2real.emulate.peripherals.registers import NotModelledError, Peripheral, nothing
from sim2real.emulate.timeline import Timeline

_PWM_MODE = 6  # high while the counter is below CCR


class PwmTimer(Peripheral):
    """TIM1, only its complementary outputs; `changed` is called after each write that changes a register."""

    name, base = "TIM1", 0x40012C00
    offsets = (
        "CR1", "", "", "", "", "EGR", "CCMR1", "", "CCER", "", "PSC", "ARR", "", "CCR1", "CCR2", "", "", "BDTR",
    )  # fmt: skip

    def __init__(self) -> None:
        self.changed = nothing
        super().__init__()

    def set(self, register: str, value: int) -> None:
        """See `Peripheral`."""
        if register == "CCMR1" and value & ~0x7070:
            raise NotModelledError(f"TIM1_CCMR1 = 0x{value:X}: expected PWM without preload")
        if register == "CCER" and value & ~0x44:
            raise NotModelledError(f"TIM1_CCER = 0x{value:X}: expected CC1NE and CC2NE alone")
        if register != "EGR" and self.values[register] != value & 0xFFFF:
            self.values[register] = value & 0xFFFF
            self.changed()

    def duty(self, channel: int) -> float:
        """The share of time, 0 to 1, for which output 0 (CH1N) or 1 (CH2N) is high."""
        values = self.values
        on = values["CR1"] & 1 and values["BDTR"] >> 15 and values["CCER"] >> (2 + 4 * channel) & 1
        if not on or values["CCMR1"] >> (4 + 8 * channel) & 7 != _PWM_MODE:
            return 0.0
        return min(values["CCR2" if channel else "CCR1"] / (values["ARR"] + 1), 1.0)

    def frequency(self, megahertz: int) -> float:
        """The frequency of the PWM [Hz] at a clock [MHz]."""
        return megahertz * 1e6 / ((self.values["PSC"] + 1) * (self.values["ARR"] + 1))


class Counter(Peripheral):
    """TIM2, counting up; a new prescaler takes effect with a write to EGR."""

    name, base = "TIM2", 0x40000000
    offsets = ("CR1", "", "", "", "", "EGR", "", "", "", "CNT", "PSC", "ARR")
    start: ClassVar[dict[str, int]] = {"ARR": 0xFFFF}

    def __init__(self, timeline: Timeline, rcc: Rcc) -> None:
        self._timeline, self._rcc = timeline, rcc
        self._divider, self._began = 1, 0
        super().__init__()

    def reset(self) -> None:
        """Set the state after a reset."""
        super().reset()
        self._divider = 1

    def get(self, register: str) -> int:
        """See `Peripheral`."""
        if register != "CNT" or not self.values["CR1"] & 1:
            return self.values[register]
        counted = (self._timeline.now - self._began) // (self._divider * self._rcc.cycle)
        return counted % (self.values["ARR"] + 1)

    def set(self, register: str, value: int) -> None:
        """See `Peripheral`."""
        if register == "EGR":
            self._divider = self.values["PSC"] + 1
        elif register == "CR1":
            self._began = self._timeline.now
            self.values["CR1"] = value
        elif register == "CNT":
            raise NotModelledError("TIM2_CNT is written: not modelled")
        else:
            self.values[register] = value & 0xFFFF
