"""Read segments and symbols of a 32-bit little-endian ELF file."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path

_HEADER = struct.Struct("<16s2H5I6H")
_PROGRAM = struct.Struct("<8I")
_SECTION = struct.Struct("<10I")
_SYMBOL = struct.Struct("<3I2BH")
_LOAD, _EXECUTABLE, _SYMBOL_TABLE, _ARM = 1, 1, 2, 40


@dataclass(frozen=True)
class Segment:
    """A loadable segment: its bytes and their physical address in flash."""

    address: int
    data: bytes
    executable: bool


@dataclass(frozen=True)
class Elf:
    """The segments to load, and the address of every named function and object (without the Thumb bit)."""

    segments: tuple[Segment, ...]
    symbols: dict[str, int]

    def address(self, name: str) -> int:
        """The address of a symbol. Raises KeyError, with a remedy, if there is none."""
        if name not in self.symbols:
            raise KeyError(f"the ELF has no symbol '{name}'; expected one that is not stripped")
        return self.symbols[name]


def read_elf(path: Path) -> Elf:
    """Read a program. Raises ValueError, in one line, if the file is no ELF file for ARM."""
    raw = path.read_bytes()
    if len(raw) < _HEADER.size or raw[:6] != b"\x7fELF\x01\x01":
        raise ValueError(f"{path.name}: expected a 32-bit little-endian ELF file")
    header = _HEADER.unpack_from(raw)
    machine, program_at, section_at = header[2], header[5], header[6]
    programs, sections = header[10], header[12]
    if machine != _ARM:
        raise ValueError(f"{path.name}: its machine is {machine}; expected {_ARM}, ARM")
    return Elf(tuple(_segments(raw, program_at, programs)), _symbols(raw, section_at, sections))


def _segments(raw: bytes, start: int, count: int) -> list[Segment]:
    found = []
    for index in range(count):
        kind, offset, _, physical, size, _, flags, _ = _PROGRAM.unpack_from(raw, start + index * _PROGRAM.size)
        if kind == _LOAD and size:
            found.append(Segment(physical, raw[offset : offset + size], bool(flags & _EXECUTABLE)))
    return found


def _symbols(raw: bytes, start: int, count: int) -> dict[str, int]:
    sections = [_SECTION.unpack_from(raw, start + index * _SECTION.size) for index in range(count)]
    symbols = {}
    for _, kind, _, _, offset, size, link, *_ in sections:
        if kind != _SYMBOL_TABLE:
            continue
        names = sections[link][4]
        for at in range(offset, offset + size, _SYMBOL.size):
            name, value, _, info, _, section = _SYMBOL.unpack_from(raw, at)
            if section and info & 15 in (0, 1, 2):  # defined; no type, object or function
                text = raw[names + name : raw.index(b"\0", names + name)].decode()
                if not text.startswith("$"):  # marks of the assembler between code and data
                    symbols[text] = value & ~1 if info & 15 == 2 else value
    return symbols
