"""A part of the loop's delay: a number with its interval, or why there is none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Part:
    """One part, by `name`; `what`: from what to what; `by`: what it was measured by.

    `value`, `low`, `high`: with its 95 % interval, in `unit`, s or ppm; None if it is not determined, and then `why`.
    """

    name: str
    what: str
    by: str
    value: float | None = None
    low: float | None = None
    high: float | None = None
    unit: str = "s"
    why: str = ""

    @property
    def determined(self) -> bool:
        """Whether there is a number."""
        return self.value is not None

    def as_dict(self) -> dict[str, Any]:
        """The part for JSON: without `why` where there is a number, without a number where there is none."""
        numbers = {"value": self.value, "low": self.low, "high": self.high, "unit": self.unit}
        return {"what": self.what, "by": self.by} | (numbers if self.determined else {"not_determined": self.why})


@dataclass(frozen=True)
class Kind:
    """What a part is, before it is measured: see `Part`."""

    name: str
    what: str
    by: str
    unit: str = "s"

    def found(self, value: float, half: float) -> Part:
        """The part with its interval `value` plus and minus `half`."""
        return Part(self.name, self.what, self.by, value, value - half, value + half, self.unit)

    def between(self, value: float, low: float, high: float) -> Part:
        """The part with its interval from `low` to `high`."""
        return Part(self.name, self.what, self.by, value, low, high, self.unit)

    def unknown(self, why: str) -> Part:
        """The part without a number, because of `why`."""
        return Part(self.name, self.what, self.by, unit=self.unit, why=why)
