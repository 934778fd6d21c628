"""Who comes to the server's door: so many at once, no more than so many bytes a second, and none that dawdles."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import cast

from aiohttp import web

MOST_STRANGERS = 64  # connections that are no page in a game; of more the oldest are closed
MOST_BYTES, BURST = 32e3, 64e3  # a second that a connection may send, and at once
DAWDLING = 10.0  # s in which a connection says what it wants
LINGERING = 1.0  # s in which what it says beyond that is still heard


class Door:
    """Lets connections in, while there is room for strangers."""

    def __init__(self) -> None:
        self._strangers: dict[asyncio.BaseProtocol, _Guarded] = {}  # by the server's protocol, the oldest first

    def opened_to(self, server: web.Server) -> Callable[[], asyncio.Protocol]:
        """What makes a server's protocol for each connection that comes."""

        def admit() -> asyncio.Protocol:
            while len(self._strangers) >= MOST_STRANGERS:
                self._strangers.pop(next(iter(self._strangers))).close()
            inner = server()
            self._strangers[inner] = _Guarded(inner, self.forget)
            return self._strangers[inner]

        return admit

    def forget(self, inner: asyncio.BaseProtocol) -> None:
        """A connection is a stranger no more: it has become a page in a game, or is gone."""
        self._strangers.pop(inner, None)


class _Guarded(asyncio.Protocol):
    """Passes on what a connection sends, and cuts off one that sends too much before any of it is looked at."""

    def __init__(self, inner: asyncio.Protocol, gone: Callable[[asyncio.BaseProtocol], None]) -> None:
        self._inner, self._gone, self._clock = inner, gone, asyncio.get_running_loop().time
        self._may_send, self._heard_at = BURST, self._clock()
        self._transport: asyncio.Transport | None = None
        self._closed = False

    def close(self) -> None:
        """Close the connection, which may not have been made yet."""
        self._closed = True
        if self._transport is not None:
            self._transport.abort()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self._transport = cast(asyncio.Transport, transport)
        self._inner.connection_made(transport)
        if self._closed:
            self._transport.abort()

    def data_received(self, data: bytes) -> None:
        now = self._clock()
        self._may_send = min(self._may_send + MOST_BYTES * (now - self._heard_at), BURST) - len(data)
        self._heard_at = now
        if self._may_send < 0.0:
            self.close()
        else:
            self._inner.data_received(data)

    def eof_received(self) -> bool | None:
        return self._inner.eof_received()

    def connection_lost(self, exc: Exception | None) -> None:
        self._gone(self._inner)
        self._inner.connection_lost(exc)

    def pause_writing(self) -> None:
        self._inner.pause_writing()

    def resume_writing(self) -> None:
        self._inner.resume_writing()
