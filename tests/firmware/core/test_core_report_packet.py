"""The report's own packet (L.1 and its errata), by Python's struct, and what its framing costs."""

from __future__ import annotations

import ctypes as c
import struct
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import pytest

from tests.firmware.core.host_core import make

PAIRS = ("t1", "t2", "volts", "c2", "c3", "c4")


class Packet(c.Structure):
    _fields_ = [*((name, c.c_float * 2) for name in PAIRS), ("idle", c.c_bool)]


@cache
def library() -> c.CDLL:
    build = Path(mkdtemp(prefix="report-"))
    make("host", f"BUILD={build}", "REPORT=1")
    found = c.CDLL(str(build / "library.so"))
    found.report_take.restype = c.c_bool
    found.report_take.argtypes = [c.c_char_p, c.c_uint8, c.POINTER(Packet)]
    return found


def packed(numbers: list[int], *, idle: bool = False) -> bytes:
    total = (sum(numbers) + 2**31) % 2**32 - 2**31
    return b"\n" + struct.pack("<13i?", *numbers, total, idle) + b"\n"


def heard(stream: bytes) -> list[tuple[float, ...]]:
    receiver, packet, found = c.create_string_buffer(64), Packet(), []
    for byte in stream:
        if library().report_take(receiver, byte, c.byref(packet)):
            values = [v for name in PAIRS for v in getattr(packet, name)]
            found.append((*values, packet.idle))
    return found


NUMBERS = [1234, 2345, 3456, 4567, 81_000, -35_000, 12_345_678, -1, 0, 100_000_000, 10, 2_560]


@pytest.mark.parametrize("idle", [False, True])
def test_a_packet_is_what_the_report_packs(idle: bool):
    meant = [n / 1e4 for n in NUMBERS[:6]] + [n / 1e8 for n in NUMBERS[6:]]
    (got,) = heard(packed(NUMBERS, idle=idle))  # one of its numbers is a newline
    assert got[:-1] == pytest.approx(meant, rel=1e-6) and got[-1] == idle


@pytest.mark.parametrize("at", [0, 1, 30, 52, 54])
def test_a_packet_with_a_byte_changed_is_refused(at: int):
    wrong = bytearray(packed(NUMBERS))
    wrong[at] ^= 0x40
    assert heard(bytes(wrong)) == []


def test_a_sum_does_not_see_numbers_that_were_swapped():
    swapped = bytearray(packed(NUMBERS))
    swapped[1:5], swapped[5:9] = swapped[5:9], swapped[1:5]
    assert len(heard(bytes(swapped))) == 1


def test_a_sum_beyond_32_bits_wraps():
    assert len(heard(packed([2**31 - 1] * 12))) == 1


def test_one_inserted_byte_costs_all_packets_from_there_on():
    """Of 60, in the fourth: the receiver never finds a beginning again. The protocol's own, which test_core_frame.py
    tries, loses two at most."""
    packets = [packed([number, *NUMBERS[1:]]) for number in range(60)]
    late = b"".join(packets[:3]) + packets[3][:20] + b"\x55" + packets[3][20:] + b"".join(packets[4:])
    assert len(heard(b"".join(packets))) == 60 and len(heard(late)) == 60 - 57


def test_it_is_no_part_of_the_program_unless_asked_for(tmp_path: Path):
    make("host", f"BUILD={tmp_path}")
    assert not hasattr(c.CDLL(str(tmp_path / "library.so")), "report_take")
