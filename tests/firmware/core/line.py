"""The protocol once more, in the plainest way, as an oracle: struct, zlib and COBS by its definition.

`python -m tests.firmware.core.line > firmware/golden.json` writes a frame of every message, for whoever
writes a third side.
"""

from __future__ import annotations

import json
import struct
import zlib

from sim2real.link.wire import messages
from sim2real.link.wire.messages import FORMATS, SCHEMA, UNCHECKED


def stuffed(plain: bytes) -> bytes:
    """COBS of less than 254 bytes: each part between zeros, its length plus one before it."""
    assert len(plain) < 254
    return b"".join(bytes([len(part) + 1]) + part for part in plain.split(b"\0"))


def frame(message: object) -> bytes:
    """A message as it stands on the line."""
    number, form = FORMATS[type(message)]
    values = []
    for value in vars(message).values():
        values += value if isinstance(value, tuple) else [value]
    return sealed(bytes([number]) + struct.pack(form, *values))


def sealed(plain: bytes) -> bytes:
    """Id and body with their CRC, as a frame."""
    crc = zlib.crc32(plain, 0 if plain[0] == UNCHECKED else SCHEMA)
    return stuffed(plain + struct.pack("<I", crc)) + b"\0"


def unstuffed(part: bytes) -> bytes:
    """A frame without its zero and COBS."""
    plain, at = b"", 0
    while at < len(part):
        plain += part[at + 1 : at + part[at]] + b"\0"
        at += part[at]
    return plain[:-1]


def read(stream: bytes) -> list[object]:
    """The messages of an undamaged stream."""
    found = []
    for part in stream.split(b"\0")[:-1]:
        plain = unstuffed(part)
        kind = next(kind for kind, (number, _) in FORMATS.items() if number == plain[0])
        assert sealed(plain[:-4]) == part + b"\0"
        numbers = iter(struct.unpack(FORMATS[kind][1], plain[1:-4]))
        values = {
            name: tuple(next(numbers) for _ in range(text.count(",") + 1)) if "tuple" in text else next(numbers)
            for name, text in kind.__annotations__.items()
        }
        found.append(kind(**values))
    return found


def config(**changed: object) -> messages.Config:
    """The gantry of the report, with gentle feedback."""
    numbers = {
        "c5": (5.2955e-6, 1.8625e-6), "c6": (0.008449, 0.002971), "c7": (0.05315, 0.05315), "pulley_radius": 0.035306,
        "supply": 24.0, "most_volts": 24.0, "x": (0.05, 0.95), "y": (0.05, 0.95), "proportional": (400.0, 400.0),
        "integral": (500.0, 500.0), "derivative": (2.0, 2.0), "off_path": 0.05, "silence": 100, "command_delay": 0,
    }  # fmt: skip
    return messages.Config(**{**numbers, **changed})


def hello(**changed: object) -> messages.Hello:
    """A host of this version."""
    numbers = {"major": messages.VERSION[0], "minor": messages.VERSION[1], "schema": SCHEMA, "token": 7, "boots": 0}
    return messages.Hello(**{**numbers, **changed})


def arm(meant: messages.Config | None = None) -> messages.Arm:
    """By the configuration that is meant, as its frame names it."""
    coded = frame(meant or config())
    plain = unstuffed(coded[:-1])
    return messages.Arm(struct.unpack("<I", plain[-4:])[0])


def golden() -> list[dict[str, object]]:
    """A frame of every message, with zeros and without."""
    traj = {
        "sequence": 258, "apply": 4_000_000_000, "life": 200_000, "volts": (12.0, -3.5), "t1": (81_000, 0),
        "t2": (120_000, 256), "rest": (0.5, 0.25), "slow": (-0.125, 0.0), "fast": (1e-5, 0.0),
    }  # fmt: skip
    telemetry = {
        "time": 65_536, "state": 3, "fault": 0, "place": (0.5, 0.25), "path": (0.5, 0.2), "pwm": (-1800, 3600),
        "angle": (0, 16383), "sequence": 258, "damaged": 1, "lost": 0, "longest": 140,
    }  # fmt: skip
    every = [
        hello(), config(), messages.Home(0.1, 0.9), arm(), messages.Disarm(), messages.Estop(),
        messages.Clear(), messages.Traj(**traj), messages.Ping(0x00FF00FF), messages.Pong(1, 2_000, 2_500),
        messages.Telemetry(**telemetry), messages.Event(0, messages.Notice.FAULTED, messages.Fault.OFF_PATH),
    ]  # fmt: skip
    return [{"message": type(one).__name__, "fields": vars(one), "frame": frame(one).hex()} for one in every]


if __name__ == "__main__":
    print(json.dumps(golden(), indent=1))
