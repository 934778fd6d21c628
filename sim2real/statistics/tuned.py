"""Tuned numbers with unit, failure mode and source; the page of thresholds lists them."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any


def tuned(value: Any, unit: str, guards: str, source: str) -> Any:
    """A field of a frozen record of tuned numbers.

    `unit`: SI, "1" where there is none. `guards`: what goes wrong with a much smaller or larger number. `source`: the
    command or test that set it, or "choice" with the reason.
    """
    return field(default=value, metadata={"unit": unit, "guards": guards, "source": source})


@dataclass(frozen=True)
class TunedNumber:
    """One number of a record, for the page of thresholds."""

    record: str
    name: str
    value: Any
    unit: str
    guards: str
    source: str


def listed(record: Any) -> list[TunedNumber]:
    """The numbers of a record whose fields are all `tuned`."""
    return [
        TunedNumber(type(record).__name__, one.name, getattr(record, one.name), **dict(one.metadata))
        for one in fields(record)
    ]
