"""Frames made by hand: an independent COBS, struct and zlib, and numbers copied from firmware/protocol.toml."""

from __future__ import annotations

import struct
import zlib

from firmware.definition import read_protocol

SCHEMA = read_protocol().schema


def stuff(plain: bytes) -> bytes:
    """COBS byte by byte, as the paper has it."""
    out, block = bytearray(), bytearray()
    for k, byte in enumerate(plain):
        if byte:
            block.append(byte)
            if len(block) == 254 and k < len(plain) - 1:
                out += b"\xff" + block
                block.clear()
        else:
            out += bytes([len(block) + 1]) + block
            block.clear()
    return bytes(out + bytes([len(block) + 1]) + block)


def unstuff(coded: bytes) -> bytes:
    """Back again, for what `stuff` gave."""
    out = bytearray()
    while coded:
        code, coded = coded[0], coded[1:]
        out += coded[: code - 1]
        coded = coded[code - 1 :]
        out += b"\0" if coded and code < 255 else b""
    return bytes(out)


def frame(number: int, layout: str, *values: float, schema: int = SCHEMA) -> bytes:
    """The frame of message `number`, whose body struct packs by `layout`."""
    plain = bytes([number]) + struct.pack("<" + layout, *values)
    return stuff(plain + struct.pack("<I", zlib.crc32(plain, 0 if number == 1 else schema))) + b"\0"


def opened(coded: bytes) -> tuple[int, bytes] | None:
    """Id and body of a frame without its zero; None if it is damaged."""
    plain = unstuff(coded)
    if len(plain) < 5:
        return None
    crc = zlib.crc32(plain[:-4], 0 if plain[0] == 1 else SCHEMA)
    return (plain[0], plain[1:-4]) if struct.pack("<I", crc) == plain[-4:] else None
