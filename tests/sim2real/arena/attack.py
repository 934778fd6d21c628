"""Hostile clients of the arena, on plain sockets."""

from __future__ import annotations

import base64
import os
import socket
import struct
from contextlib import suppress
from urllib.parse import parse_qs, urlsplit

TEXT, PING, PONG = 1, 9, 10  # of WebSocket frames
AIM = b'{"kind":"aim","x":0.3,"y":0.2,"sent":77}'


def frame(payload: bytes, kind: int = TEXT, last: bool = True, claimed: int | None = None) -> bytes:
    """A masked WebSocket frame; claimed: the length that it says it has."""
    length = len(payload) if claimed is None else claimed
    head = bytes([0x80 * last | kind])
    if length < 126:
        size = bytes([0x80 | length])
    elif length < 1 << 16:
        size = b"\xfe" + struct.pack("!H", length)
    else:
        size = b"\xff" + struct.pack("!Q", length)
    return head + size + bytes(4) + payload  # a mask of zeros


# name: (bytes that a page sends in one write once it is in, the number of messages in it)
SAID = {
    "aims": (frame(AIM) * 5000, 5000),
    "empty messages": (frame(b"") * 20_000, 20_000),
    "parts without an end": (frame(b"x", last=False) + frame(b"", 0, last=False) * 20_000, 20_000),
    "pings": (frame(b"", PING) * 20_000, 20_000),
    "pongs": (frame(b"", PONG) * 20_000, 20_000),
    "no JSON": (frame(b"{") * 20_000, 20_000),
    "huge messages": (frame(b"x" * 500_000) * 4, 4),
    "huge by its own word": (frame(b"", claimed=1 << 62) * 10_000, 10_000),
    "no frames": (b"\xff" * 200_000, 1),
}  # fmt: skip
# The same for who has not asked for anything before
ASKED = {
    "requests": (b"GET / HTTP/1.1\r\nHost: x\r\n\r\n" * 20_000, 20_000),
    "headers": (b"GET / HTTP/1.1\r\n" + b"a: b\r\n" * 50_000, 50_000),
    "a long line": (b"GET /" + b"x" * 1_000_000, 1),
    "a body": (b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 9000000\r\n\r\n" + b"x" * 1_000_000, 1),
    "no words": (bytes(100_000), 1),
}


def connect(address: str) -> socket.socket:
    """A connection to an arena that says nothing."""
    parts = urlsplit(address)
    return socket.create_connection((parts.hostname or "", parts.port or 0), timeout=20.0)


def watcher(address: str, watch: str) -> socket.socket:
    """One that has asked to look on at a game, and does not listen."""
    parts, line = urlsplit(address), connect(address)
    token, key = parse_qs(parts.query)["token"][0], base64.b64encode(os.urandom(16)).decode()
    line.sendall(
        f"GET /game?token={token}&watch={watch} HTTP/1.1\r\nHost: {parts.netloc}\r\n"
        f"Origin: {parts.scheme}://{parts.netloc}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        f"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n\r\n".encode()
    )
    return line


def is_closed_after(line: socket.socket, said: bytes) -> bool:
    """Whether the other side closes a connection on which all of this is said."""
    with line, suppress(ConnectionError):
        line.sendall(said)
        try:
            while line.recv(1 << 16):
                pass
        except TimeoutError:
            return False
    return True


def half_open(address: str, watch: str, number: int) -> list[socket.socket]:
    """Connections that say nothing, break off in a request, and look on without ever answering, in turn."""
    held = []
    for k in range(number):
        line = watcher(address, watch) if k % 3 == 2 else connect(address)
        if k % 3 == 1:
            line.sendall(b"GET / HTTP/1.1\r\nHost: ")
        held.append(line)
    return held


def is_open(line: socket.socket) -> bool:
    """Whether the server still holds a connection; one that it let go is closed here, too."""
    line.setblocking(False)
    try:
        while line.recv(1 << 16):
            pass
    except BlockingIOError:
        return True
    except ConnectionError:
        pass
    line.close()
    return False
