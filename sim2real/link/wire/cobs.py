"""Consistent overhead byte stuffing: an encoding without zero bytes, so that a zero can end a frame.

After Cheshire and Baker, "Consistent Overhead Byte Stuffing", IEEE/ACM Transactions on Networking 7 (1999).
"""

from __future__ import annotations

FULL = 0xFF  # code of a block of 254 bytes that no zero follows


def encode(plain: bytes) -> bytes:
    """Encode bytes without zeros: one byte longer, and one more for every full 254 bytes without a zero."""
    coded = bytearray()
    groups = plain.split(b"\0")
    for k, group in enumerate(groups):
        while len(group) >= FULL - 1:
            coded += bytes([FULL]) + group[: FULL - 1]
            group = group[FULL - 1 :]
            if not group and k == len(groups) - 1:  # a full block at the end needs no other after it
                return bytes(coded)
        coded += bytes([len(group) + 1]) + group
    return bytes(coded)


def decode(coded: bytes) -> bytes:
    """Decode what `encode` returned. Raises ValueError for anything else: no bytes, a zero, a truncated block."""
    if not coded or 0 in coded:
        raise ValueError(f"{coded[:20].hex(' ') or 'nothing'} is not COBS; expected one byte or more, none of them 0")
    plain = bytearray()
    at = 0
    while at < len(coded):
        code = coded[at]
        block = coded[at + 1 : at + code]
        at += code
        if len(block) < code - 1:
            raise ValueError(f"{coded[:20].hex(' ')} is not COBS; its last block lacks {code - 1 - len(block)} bytes")
        plain += block
        if code < FULL and at < len(coded):
            plain.append(0)
    return bytes(plain)
