"""Frames on the wire: COBS of (id, body, CRC-32), then a zero; written whole, read byte by byte, whatever comes."""

from __future__ import annotations

import struct
import zlib
from dataclasses import asdict, dataclass

from sim2real.link import bodies, cobs
from sim2real.link.bodies import Message
from sim2real.link.messages import FORMATS, SCHEMA, UNCHECKED

KINDS = {number: kind for kind, (number, _) in FORMATS.items()}
CRC = 4  # bytes
_PLAIN = 1 + max(struct.calcsize(text) for _, text in FORMATS.values()) + CRC
LONGEST = _PLAIN + 1 + _PLAIN // 254  # bytes of a frame without its zero


def _crc(plain: bytes) -> bytes:
    """Begun at the schema, so that programs of different schemas understand nothing of each other but `hello`."""
    return zlib.crc32(plain, 0 if plain[:1] == bytes([UNCHECKED]) else SCHEMA).to_bytes(CRC, "little")


def encode(message: Message) -> bytes:
    """The frame of a message. ValueError, in one line, names a field outside its limits."""
    body = bodies.pack(message)
    plain = bytes([FORMATS[type(message)][0]]) + body
    return cobs.encode(plain + _crc(plain)) + b"\0"


def seal(message: Message) -> int:
    """The CRC-32 at the end of a message's frame, by which `arm` names a configuration."""
    plain = bytes([FORMATS[type(message)][0]]) + bodies.pack(message)
    return int.from_bytes(_crc(plain), "little")


@dataclass
class Tally:
    """Frames since the start, by what became of them."""

    good: int = 0
    malformed: int = 0  # no COBS
    wrong_length: int = 0  # not that of its message, or too short for any
    wrong_crc: int = 0  # damaged, or of another schema
    unknown_id: int = 0
    out_of_range: int = 0  # a number outside its limits, or none
    overlong: int = 0  # longer than any message

    @property
    def refused(self) -> int:
        """All but the good ones."""
        return sum(asdict(self).values()) - self.good


class Receiver:
    """Bytes as they come to messages. It never raises; what it could not read is counted in `tally`."""

    def __init__(self) -> None:
        self.tally = Tally()
        self._kept = bytearray()  # of the frame that is not yet whole
        self._skipping = False  # a frame that is too long, up to its zero

    def feed(self, data: bytes) -> list[Message]:
        """The messages that `data` completes, in order. Zeros may stand between frames."""
        *whole, rest = data.split(b"\0")
        messages = []
        for part in whole:
            self._keep(part)
            if not self._skipping and self._kept and (message := self._read(bytes(self._kept))) is not None:
                messages.append(message)
            self._kept.clear()
            self._skipping = False
        self._keep(rest)
        return messages

    def _keep(self, part: bytes) -> None:
        if not self._skipping and len(self._kept) + len(part) > LONGEST:
            self.tally.overlong += 1
            self._skipping = True
            self._kept.clear()
        if not self._skipping:
            self._kept += part

    def _read(self, coded: bytes) -> Message | None:
        try:
            plain = cobs.decode(coded)
        except ValueError:
            self.tally.malformed += 1
            return None
        if len(plain) <= CRC:
            self.tally.wrong_length += 1
        elif _crc(plain[:-CRC]) != plain[-CRC:]:
            self.tally.wrong_crc += 1
        elif plain[0] not in KINDS:
            self.tally.unknown_id += 1
        elif len(plain) - 1 - CRC != struct.calcsize(FORMATS[KINDS[plain[0]]][1]):
            self.tally.wrong_length += 1
        else:
            return self._unpack(KINDS[plain[0]], plain[1:-CRC])
        return None

    def _unpack(self, kind: type, body: bytes) -> Message | None:
        try:
            message = bodies.unpack(kind, body)
        except ValueError:
            self.tally.out_of_range += 1
            return None
        self.tally.good += 1
        return message
