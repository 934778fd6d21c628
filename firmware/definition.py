"""The protocol's definition, read and checked: `protocol.toml` as records."""

from __future__ import annotations

import tomllib
import zlib
from dataclasses import dataclass
from pathlib import Path

from firmware import PROTOCOL

# type in the definition: (C type, format of Python's struct, bytes)
TYPES = {
    "u8": ("uint8_t", "B", 1),
    "u16": ("uint16_t", "H", 2),
    "u32": ("uint32_t", "I", 4),
    "i16": ("int16_t", "h", 2),
    "i32": ("int32_t", "i", 4),
    "f32": ("float", "f", 4),
}
FROM = ("host", "board", "both")
UNCHECKED = 1  # id of the message whose CRC begins at 0: `hello`, by which different schemas know each other


@dataclass(frozen=True)
class Field:
    """One number of a message, or `count` of them."""

    name: str
    type: str
    count: int = 1
    unit: str = ""
    low: float | None = None
    high: float | None = None
    doc: str = ""

    def __post_init__(self) -> None:
        if self.type not in TYPES:
            raise ValueError(f"field {self.name}: type is '{self.type}'; known: {', '.join(TYPES)}")
        if (self.low is None) != (self.high is None) or self.count < 1:
            raise ValueError(f"field {self.name}: expected both low and high, or neither, and a count from 1 on")
        if self.low is not None and self.type[0] == "i":
            raise ValueError(
                f"field {self.name}: a {self.type} has no limits; expected them for u8 to u32 and f32 alone"
            )


@dataclass(frozen=True)
class Message:
    """A message's fields, in the order of its body."""

    name: str
    id: int
    sender: str
    doc: str
    fields: tuple[Field, ...]

    @property
    def size(self) -> int:
        """Bytes of the body."""
        return sum(TYPES[field.type][2] * field.count for field in self.fields)


@dataclass(frozen=True)
class Enum:
    """Named numbers from 0 on, each with what it means."""

    name: str
    doc: str
    values: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Protocol:
    """All that both sides must agree on."""

    version: tuple[int, int]
    messages: tuple[Message, ...]
    enums: tuple[Enum, ...]

    @property
    def schema(self) -> int:
        """A number that changes with anything that a receiver relies on; what is only said of it may change freely."""
        parts = [f"{one.id} {one.name} {one.sender}:" + ",".join(map(_relied_on, one.fields)) for one in self.messages]
        parts += [f"{e.name}:" + ",".join(name for name, _ in e.values) for e in self.enums]
        return zlib.crc32(";".join([str(self.version[0]), *parts]).encode())


def _relied_on(field: Field) -> str:
    return f"{field.name} {field.type}*{field.count}[{field.low}:{field.high}]{field.unit}"


def read_protocol(path: Path = PROTOCOL) -> Protocol:
    """The definition in `path`. ValueError, in one line, for one that does not hold together."""
    raw = tomllib.loads(path.read_text(encoding="utf-8"))
    messages = tuple(
        Message(one["name"], one["id"], one["from"], one["doc"], tuple(Field(**field) for field in one["fields"]))
        for one in raw["message"]
    )
    enums = tuple(Enum(one["name"], one["doc"], tuple((n, d) for n, d in one["values"])) for one in raw["enum"])
    ids = [message.id for message in messages]
    if ids != list(range(1, len(ids) + 1)):  # by which the firmware finds a message's layout
        raise ValueError(f"{path.name}: ids are {ids}; expected 1, 2, 3 and so on, in this order")
    for message in messages:
        if message.sender not in FROM:
            raise ValueError(f"{path.name}: {message.name} is from '{message.sender}'; known: {', '.join(FROM)}")
    return Protocol(tuple(raw["version"]), messages, enums)
