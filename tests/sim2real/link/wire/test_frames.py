"""Frames against those made by hand, and what becomes of a stream that is damaged."""

from __future__ import annotations

import itertools
import math
import struct
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim2real.link.wire.frames import FrameCounts, Receiver, encode
from sim2real.link.wire.messages import Arm, Config, Disarm, Event, Hello, Home, Ping, Pong, Telemetry, Traj
from tests.sim2real.link.reference_wire import SCHEMA, frame, stuff

CONFIG = Config(
    (1e-9, 2e-6), (1e-4, 2e-4), (0.125, 0.25), 0.03125, 24.0, 12.0, (0.0, 1.0), (-0.5, 0.5), (1.0, 2.0), (3.0, 4.0),
    (5.0, 6.0), 0.0625, 250, 4500,
)  # fmt: skip
TRAJ = Traj(7, 4_000_000_000, 50_000, (12.0, -6.5), (1, 2), (3, 4), (0.5, 0.25), (-0.5, 0.125), (0.0, 0.0009765625))
TELEMETRY = Telemetry(2**32 - 1, 3, 0, (0.5, -0.25), (1.0, 2.0), (-3600, 3600), (16383, 0), 9, 65535, 0, 321)
# message, its frame by hand; the numbers of ids and the letters are copied from protocol.toml
BY_HAND = [
    (Hello(1, 0, 0xDEADBEEF, 5, 0), frame(1, "BBIII", 1, 0, 0xDEADBEEF, 5, 0)),
    (
        CONFIG,
        frame(2, "ff ff ff f f f ff ff ff ff ff f H H", 1e-9, 2e-6, 1e-4, 2e-4, 0.125, 0.25, 0.03125, 24, 12, 0, 1,
              -0.5, 0.5, 1, 2, 3, 4, 5, 6, 0.0625, 250, 4500),
    ),
    (Home(0.5, -0.5), frame(3, "ff", 0.5, -0.5)),
    (Arm(0x01020304), frame(4, "I", 0x01020304)),
    (
        TRAJ,
        frame(8, "III ff II II ff ff ff", 7, 4_000_000_000, 50_000, 12, -6.5, 1, 2, 3, 4, 0.5, 0.25, -0.5, 0.125, 0,
              2.0**-10),
    ),
    (Ping(0), frame(9, "I", 0)),
    (Pong(1, 2, 2**32 - 1), frame(10, "III", 1, 2, 2**32 - 1)),
    (
        TELEMETRY,
        frame(11, "I BB ff ff hh HH I HHH", 2**32 - 1, 3, 0, 0.5, -0.25, 1, 2, -3600, 3600, 16383, 0, 9, 65535, 0, 321),
    ),
    (Event(1, 3, 0x0801), frame(12, "IBI", 1, 3, 0x0801)),
]  # fmt: skip
STREAM = b"".join(wire for _, wire in BY_HAND)
SENT = [message for message, _ in BY_HAND[2:]] + [replace(CONFIG, silence=251), TELEMETRY]


def nearly(message: object) -> object:
    """For comparison: numbers as 32 bits have them."""
    values = {}
    for name, value in vars(message).items():
        many = value if isinstance(value, tuple) else (value,)
        values[name] = tuple(struct.unpack("f", struct.pack("f", v))[0] if isinstance(v, float) else v for v in many)
    return type(message), values


@pytest.mark.parametrize("message, wire", BY_HAND)
def test_as_by_hand(message, wire):
    assert encode(message) == wire
    receiver = Receiver()
    (read,) = receiver.feed(wire)
    assert nearly(read) == nearly(message)
    assert receiver.counts == FrameCounts(good=1)


@given(st.lists(st.integers(0, len(STREAM)), max_size=12))
def test_a_stream_in_any_pieces(cuts):
    receiver, places = Receiver(), [0, *sorted(cuts), len(STREAM)]
    read = [m for a, b in itertools.pairwise(places) for m in receiver.feed(STREAM[a:b])]
    assert [nearly(m) for m in read] == [nearly(m) for m, _ in BY_HAND]


@given(st.sampled_from(["flip", "drop", "insert"]), st.floats(0, 1, exclude_max=True), st.integers(1, 255))
def test_one_wrong_byte_costs_two_frames_at_most(how, where, change):
    """And what comes out is a part, in order, of what was sent."""
    stream = b"".join(map(encode, SENT))
    at = int(where * len(stream))
    middle = {
        "flip": bytes([stream[at] ^ change]),
        "drop": b"",
        "insert": bytes([change - 1]) + stream[at : at + 1],
    }[how]
    receiver = Receiver()
    read = [nearly(m) for m in receiver.feed(stream[:at] + middle + stream[at + 1 :])]
    left = iter([nearly(m) for m in SENT])
    assert all(any(one == other for other in left) for one in read)
    assert len(read) >= len(SENT) - 2
    assert receiver.counts.good == len(read)


@given(st.binary(max_size=400))
def test_garbage_gives_nothing_and_the_next_frame_comes_through(garbage):
    receiver = Receiver()
    assert receiver.feed(garbage) == []
    assert receiver.feed(b"\0") == []
    assert receiver.feed(encode(Ping(3))) == [Ping(3)]


@pytest.mark.parametrize(
    "wire, reason",
    [
        (b"\x05\x11\0", "malformed"),
        (stuff(b"\x04\x01\x02") + b"\0", "wrong_length"),
        (frame(9, "IB", 1, 2), "wrong_length"),
        (frame(9, "H", 1), "wrong_length"),
        (frame(5, "", schema=SCHEMA ^ 1), "wrong_crc"),
        (frame(9, "I", 5, schema=0), "wrong_crc"),
        (frame(99, "I", 5), "unknown_id"),
        (frame(3, "ff", 5.5, 0.0), "out_of_range"),
        (frame(3, "ff", math.nan, 0.0), "out_of_range"),
        (frame(11, "I BB ff ff hh HH I HHH", 1, 3, 0, math.inf, *([0] * 11)), "out_of_range"),
        (b"\x01" * 5000 + b"\0", "overlong"),
        (frame(50, "200B", *([7] * 200)), "overlong"),
    ],
)
def test_what_is_refused_is_counted_by_its_reason(wire, reason):
    receiver = Receiver()
    assert receiver.feed(wire + frame(9, "I", 8)) == [Ping(8)]
    assert receiver.counts == FrameCounts(good=1, **{reason: 1})
    assert receiver.counts.refused == 1


def test_an_overlong_frame_in_pieces_is_counted_once_and_not_kept():
    receiver = Receiver()
    for _ in range(1000):
        assert receiver.feed(b"\x01" * 50) == []
    assert receiver.counts == FrameCounts(overlong=1)
    assert receiver.feed(b"\0" + frame(9, "I", 8)) == [Ping(8)]


def test_zeros_between_frames_are_nothing():
    receiver = Receiver()
    assert receiver.feed(b"\0\0" + frame(5, "") + b"\0\0\0") == [Disarm()]
    assert receiver.counts == FrameCounts(good=1)


@pytest.mark.parametrize(
    "message, text",
    [
        (Home(5.5, 0.0), "Home.x is 5.5; expected a number from -5 to 5"),
        (Home(0.0, math.nan), "Home.y is nan; expected a number from -5 to 5"),
        (Home(0.0, "up"), "Home.y is 'up'; expected a number from -5 to 5"),  # pyright: ignore[reportArgumentType]
        (replace(TRAJ, t1=(0, 10_000_001)), "Traj.t1 is 10000001; expected a whole number from 0 to 10000000"),
        (replace(TRAJ, life=0.5), "Traj.life is 0.5; expected a whole number from 1000 to 5000000"),
        (replace(TRAJ, volts=(1.0,)), "Traj.volts is (1.0,); expected 2 numbers"),
        (replace(TRAJ, sequence=2**32), "Traj.sequence is 4294967296; expected a whole number from 0 to 4294967295"),
        (replace(CONFIG, silence=5), "Config.silence is 5; expected a whole number from 10 to 1000"),
        (replace(TELEMETRY, place=(math.inf, 0.0)), "Telemetry.place is inf; expected a number from -3.40282347e+38"),
        ("hello", "'hello' is no message; expected one of Hello, Config, Home"),
    ],
)
def test_what_cannot_be_sent_is_refused_in_one_line(message, text):
    with pytest.raises(ValueError) as refusal:
        encode(message)
    assert str(refusal.value).startswith(text) and "\n" not in str(refusal.value)


def test_limits_hold_after_rounding_to_32_bits():
    """1e-9 is less in 32 bits than in 64; it is inside all the same, on both sides."""
    (read,) = Receiver().feed(encode(replace(CONFIG, c5=(1e-9, 1e-2), most_volts=0.1)))
    assert read.c5 == pytest.approx((1e-9, 1e-2), rel=1e-6)
