"""COBS against its published examples and an independent one."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim2real.link.wire import cobs
from tests.sim2real.link.reference_wire import stuff

RUN = bytes(range(1, 0xFF))  # 254 bytes, no zero
# plain, coded: the table in Wikipedia's "Consistent Overhead Byte Stuffing", examples 1 to 11
PUBLISHED = [
    ("00", "01 01"),
    ("00 00", "01 01 01"),
    ("00 11 00", "01 02 11 01"),
    ("11 22 00 33", "03 11 22 02 33"),
    ("11 22 33 44", "05 11 22 33 44"),
    ("11 00 00 00", "02 11 01 01 01"),
    (RUN.hex(), "ff" + RUN.hex()),
    ("00" + RUN.hex(), "01 ff" + RUN.hex()),
    (RUN.hex() + "ff", "ff" + RUN.hex() + "02 ff"),
    (RUN[1:].hex() + "ff 00", "ff" + RUN[1:].hex() + "ff 01 01"),
    (RUN[2:].hex() + "ff 00 01", "fe" + RUN[2:].hex() + "ff 02 01"),
]
mostly_zeros_and_runs = st.lists(
    st.one_of(st.binary(max_size=4), st.integers(250, 260).map(lambda n: b"\x07" * n), st.just(b"\0")), max_size=8
).map(b"".join)


@pytest.mark.parametrize("plain, coded", PUBLISHED)
def test_published_examples(plain, coded):
    assert cobs.encode(bytes.fromhex(plain)) == bytes.fromhex(coded)
    assert cobs.decode(bytes.fromhex(coded)) == bytes.fromhex(plain)


@given(mostly_zeros_and_runs)
def test_there_and_back(plain):
    coded = cobs.encode(plain)
    assert 0 not in coded and len(coded) <= len(plain) + 1 + len(plain) // 254
    assert cobs.decode(coded) == plain
    assert coded == stuff(plain)


@given(st.binary(max_size=300))
def test_anything_is_decoded_or_refused(coded):
    try:
        plain = cobs.decode(coded)
    except ValueError as error:
        assert "\n" not in str(error) and "is not COBS" in str(error)
    else:
        assert len(plain) < len(coded)


@pytest.mark.parametrize("coded", ["", "00", "03 11", "01 00", "ff 01 02", "02"])
def test_malformed(coded):
    with pytest.raises(ValueError, match="is not COBS"):
        cobs.decode(bytes.fromhex(coded))
