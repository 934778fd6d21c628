"""Frames on the line: COBS of (id, body, CRC-32), then a zero. A receiver reads them from any stream of bytes."""

from __future__ import annotations

import struct
import zlib
from dataclasses import asdict, dataclass

from sim2real.link.wire import bodies, cobs
from sim2real.link.wire.bodies import Message
from sim2real.link.wire.messages import FORMATS, SCHEMA, UNCHECKED

KINDS = {number: kind for kind, (number, _) in FORMATS.items()}
_SIZES = {number: struct.calcsize(text) for number, text in FORMATS.values()}
CRC = 4  # bytes
_PLAIN = 1 + max(_SIZES.values()) + CRC
LONGEST = _PLAIN + 1 + _PLAIN // 254  # bytes of a frame without its zero


def _crc(plain: bytes) -> bytes:
    """The CRC-32, with the schema as its initial value, so that programs of different schemas accept nothing from each
    other but `hello`."""
    return zlib.crc32(plain, 0 if plain[:1] == bytes([UNCHECKED]) else SCHEMA).to_bytes(CRC, "little")


def encode(message: Message) -> bytes:
    """Encode a message as a frame. Raises ValueError, in one line, for a field outside its limits."""
    body = bodies.pack(message)
    plain = bytes([FORMATS[type(message)][0]]) + body
    return cobs.encode(plain + _crc(plain)) + b"\0"


def frame_crc(message: Message) -> int:
    """The CRC-32 of a message's frame, by which `arm` identifies a configuration."""
    plain = bytes([FORMATS[type(message)][0]]) + bodies.pack(message)
    return int.from_bytes(_crc(plain), "little")


@dataclass
class FrameCounts:
    """The number of received frames by outcome."""

    good: int = 0
    malformed: int = 0  # invalid COBS
    wrong_length: int = 0  # not the length of its message, or too short for any
    wrong_crc: int = 0  # damaged, or of another schema
    unknown_id: int = 0
    out_of_range: int = 0  # a number outside its limits, or not a number
    overlong: int = 0  # longer than any message

    @property
    def refused(self) -> int:
        """The number of frames that were not accepted."""
        return sum(asdict(self).values()) - self.good


class Receiver:
    """Decodes a stream of bytes into messages. It never raises; rejected frames are counted in `counts`."""

    def __init__(self) -> None:
        self.counts = FrameCounts()
        self._kept = bytearray()  # bytes of the incomplete frame
        self._skipping = False  # whether an overlong frame is skipped up to its zero

    def feed(self, data: bytes) -> list[Message]:
        """The messages that `data` completes, in order. Extra zeros between frames are ignored."""
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
            self.counts.overlong += 1
            self._skipping = True
            self._kept.clear()
        if not self._skipping:
            self._kept += part

    def _read(self, coded: bytes) -> Message | None:
        try:
            plain = cobs.decode(coded)
        except ValueError:
            self.counts.malformed += 1
            return None
        if len(plain) <= CRC:
            self.counts.wrong_length += 1
        elif _crc(plain[:-CRC]) != plain[-CRC:]:
            self.counts.wrong_crc += 1
        elif plain[0] not in KINDS:
            self.counts.unknown_id += 1
        elif len(plain) - 1 - CRC != _SIZES[plain[0]]:
            self.counts.wrong_length += 1
        else:
            return self._unpack(KINDS[plain[0]], plain[1:-CRC])
        return None

    def _unpack(self, kind: type, body: bytes) -> Message | None:
        try:
            message = bodies.unpack(kind, body)
        except ValueError:
            self.counts.out_of_range += 1
            return None
        self.counts.good += 1
        return message
