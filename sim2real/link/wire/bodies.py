"""Pack messages into the bytes of their bodies and unpack them, with checks of all limits."""

from __future__ import annotations

import math
import re
import struct
from dataclasses import fields
from typing import Any

from sim2real.link.wire.messages import FORMATS, LIMITS, MESSAGES

Message = Any  # one of messages.MESSAGES

# limits by the code of Python's struct
_WHOLE = {"B": (0, 0xFF), "H": (0, 0xFFFF), "I": (0, 0xFFFFFFFF), "h": (-0x8000, 0x7FFF), "i": (-(2**31), 2**31 - 1)}
_MOST_FLOAT = float.fromhex("0x1.fffffep127")  # greatest float of 32 bits


def _layout(kind: type) -> list[tuple[str, str, int]]:
    """Name, code and count of each field of a kind of message."""
    codes = re.findall(r"(\d*)([BHIhif])", FORMATS[kind][1])
    return [(f.name, code, int(count or 1)) for f, (count, code) in zip(fields(kind), codes, strict=True)]


LAYOUTS = {kind: _layout(kind) for kind in MESSAGES}


def pack(message: Message) -> bytes:
    """Pack a message into its body. Raises ValueError, in one line, if a field is not a number within its limits, or
    has the wrong number of elements."""
    kind = type(message)
    if kind not in LAYOUTS:
        raise ValueError(f"{message!r} is no message; expected one of {', '.join(one.__name__ for one in MESSAGES)}")
    numbers: list[float] = []
    for name, code, count in LAYOUTS[kind]:
        given = getattr(message, name)
        values = [given] if count == 1 else _several(kind, name, given, count)
        low, high = LIMITS.get(kind, {}).get(name) or _WHOLE.get(code, (-_MOST_FLOAT, _MOST_FLOAT))
        numbers += [_number(f"{kind.__name__}.{name}", value, code, low, high) for value in values]
    return struct.pack(FORMATS[kind][1], *numbers)


def _several(kind: type, name: str, given: Any, count: int) -> list[Any]:
    try:
        values = list(given)
    except TypeError:
        values = []
    if len(values) != count:
        raise ValueError(f"{kind.__name__}.{name} is {given!r}; expected {count} numbers")
    return values


def _number(place: str, value: Any, code: str, low: float, high: float) -> float:
    try:
        number = float(value) if code == "f" else value.__index__()
    except (TypeError, ValueError, AttributeError, OverflowError):
        number = math.nan
    if not low <= number <= high:  # so that no number (nan) is refused too
        what = "a number" if code == "f" else "a whole number"
        raise ValueError(f"{place} is {value!r}; expected {what} from {low:.9g} to {high:.10g}")
    return number


def unpack(kind: type, body: bytes) -> Message:
    """Unpack a body into a message of this kind. Raises ValueError for a number outside its limits, and struct.error
    for a wrong length."""
    numbers = struct.unpack(FORMATS[kind][1], body)
    values: list[Any] = []
    begin = 0
    for name, count, low, high in _RECEIVED[kind]:
        several = numbers[begin : begin + count]
        begin += count
        for value in several:
            if not low <= value <= high:
                raise ValueError(f"{kind.__name__}.{name} is {several}; expected from {low:.9g} to {high:.10g}")
        values.append(several if count > 1 else several[0])
    return kind(*values)


def _as_received(kind: type, name: str, code: str) -> tuple[float, float]:
    """The limits rounded to 32 bits, like the received numbers: a lower limit of 1e-9 arrives as slightly less."""
    low, high = LIMITS.get(kind, {}).get(name) or _WHOLE.get(code, (-_MOST_FLOAT, _MOST_FLOAT))
    return struct.unpack("<2f", struct.pack("<2f", low, high)) if code == "f" else (low, high)


_RECEIVED = {
    kind: [(name, count, *_as_received(kind, name, code)) for name, code, count in layout]
    for kind, layout in LAYOUTS.items()
}
