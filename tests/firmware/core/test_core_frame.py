"""What the firmware hears and says on a line that drops, flips and inserts bytes."""

from __future__ import annotations

import ctypes as c
import json
import random
import struct

import pytest

from firmware import FOLDER
from sim2real.link.wire import messages
from tests.firmware.core.host_core import Core, library
from tests.firmware.core.line import frame, hello, read, sealed

GOLDEN = json.loads((FOLDER / "golden.json").read_text())
ANGLE = (0x1235, 0x1235)  # an even number of ones, as an encoder sends


class Receiver(c.Structure):
    _fields_ = [("kept", c.c_uint8 * 256)]  # more than it has; it is the firmware's alone


class Frame(c.Structure):
    _fields_ = [("layout", c.POINTER(c.c_uint8)), ("body", c.POINTER(c.c_uint8)), ("crc", c.c_uint32)]


class Line:
    """A receiver of the firmware."""

    OPEN, GOOD, DAMAGED = range(3)

    def __init__(self) -> None:
        self.receiver, self.frame = Receiver(), Frame()
        self.take = library().frame_take
        self.pieces = random.Random(0)

    def hear(self, data: bytes) -> tuple[list[int], int]:
        """Ids of the good frames in the data, and how many were damaged."""
        ids, damaged = [], 0
        while data:
            piece = data[: self.pieces.randint(1, 40)]  # as the line brings them
            count = c.c_size_t(len(piece))
            result = self.take(c.byref(self.receiver), piece, c.byref(count), c.byref(self.frame))
            if result == self.GOOD:
                ids.append(self.frame.layout[0])
            damaged += result == self.DAMAGED
            data = data[count.value :]
        return ids, damaged


def test_golden_frames_are_what_the_protocol_says():
    for golden in GOLDEN:
        kind = getattr(messages, golden["message"])
        values = {name: tuple(value) if isinstance(value, list) else value for name, value in golden["fields"].items()}
        assert frame(kind(**values)).hex() == golden["frame"]
    assert {golden["message"] for golden in GOLDEN} == {kind.__name__ for kind in messages.MESSAGES}


@pytest.mark.parametrize("golden", GOLDEN, ids=lambda golden: golden["message"])
def test_the_firmware_hears_and_says_golden_frames(golden: dict):
    kind, data = getattr(messages, golden["message"]), bytes.fromhex(golden["frame"])
    number, form = messages.FORMATS[kind]
    assert Line().hear(data) == ([number], 0)
    numbers = [n for value in golden["fields"].values() for n in (value if isinstance(value, list) else [value])]
    aligned = struct.pack(form.replace("<", "@"), *numbers)  # as the compiler lays a structure out
    out = c.create_string_buffer(256)
    put = library().frame_put
    put.restype, put.argtypes = c.c_size_t, [c.c_char_p, c.c_int, c.c_char_p]
    length = put(out, number, aligned)
    assert out.raw[:length] == data


def test_it_says_what_python_reads():
    core, sent = Core(boots=77), b""
    for tick in range(60):
        sent += core.step(1000 * tick, ANGLE, frame(hello(token=99)) if tick == 50 else b"").sent
    found = read(sent)
    assert messages.Hello(*messages.VERSION, messages.SCHEMA, 99, 77) in found
    telemetry = [one for one in found if isinstance(one, messages.Telemetry)]
    assert len(telemetry) == 30 and telemetry[-1].angle == ANGLE
    events = [one for one in found if isinstance(one, messages.Event)]
    assert [(one.code, one.detail) for one in events] == [
        (messages.Notice.BOOTED, 0),
        (messages.Notice.STATE, messages.State.UNHOMED),
    ]


@pytest.mark.parametrize("kind", messages.MESSAGES)
def test_every_message_is_known_by_its_length(kind: type):
    number, form = messages.FORMATS[kind]
    good = bytes([number]) + bytes(struct.calcsize(form))
    assert Line().hear(sealed(good)) == ([number], 0)
    assert Line().hear(sealed(good + b"\1")) == ([], 1)
    if len(good) > 1:
        assert Line().hear(sealed(good[:-1])) == ([], 1)


def test_unknown_empty_and_endless_frames():
    line, ping = Line(), frame(messages.Ping(5))
    assert line.hear(sealed(bytes([200, 1, 2]))) == ([], 1)
    assert line.hear(b"\0\0\0") == ([], 0)
    assert line.hear(b"\x05\1\0") == ([], 1)  # says more than there is
    assert line.hear(b"\xff" * 4000 + b"\0" + ping) == ([9], 1)
    assert line.hear(b"\0" * 500 + ping) == ([9], 0)
    assert line.hear(frame(messages.Ping(0))[:-3] + b"\0" + ping) == ([9], 1)  # cut short


def damage(data: bytes, how: str, rng: random.Random) -> bytes:
    at = rng.randrange(len(data))
    if how == "flipped":
        return data[:at] + bytes([data[at] ^ rng.randrange(1, 256)]) + data[at + 1 :]
    if how == "lost":
        return data[:at] + data[at + 1 :]
    if how == "doubled":
        return data[:at] + data[at : at + 1] + data[at:]
    return data[:at] + bytes([rng.randrange(256)]) + data[at:]


@pytest.mark.parametrize("how", ["flipped", "lost", "inserted", "doubled"])
def test_one_bad_byte_costs_two_frames_at_most(how: str):
    """Some thousand trials; `python -m tests.firmware.campaign` has 10^5 of each, and 10^7 frames."""
    rng = random.Random(how)
    for _ in range(1500):
        tokens = [rng.choice([0, 1, rng.getrandbits(32)]) for _ in range(6)]
        stream = b"".join(frame(messages.Ping(token)) for token in tokens)
        ids, _ = Line().hear(damage(stream, how, rng) + b"\0")
        assert len(ids) >= len(tokens) - 2 and set(ids) <= {9}
