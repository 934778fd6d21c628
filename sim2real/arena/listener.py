"""A page that looks on, and what waits to be sent to it."""

from __future__ import annotations

import asyncio
import time
from collections import deque
from collections.abc import Callable

from aiohttp import WSCloseCode, WSMsgType, web

from sim2real.arena import messages

STALE = 5.0  # s that one message may take to go out
MOST_SAID, BURST = 200.0, 800.0  # messages a second that a page may send, and at once where its line stood still
AT_ONCE = 50  # messages of one page, before the games go on


class Listener:
    """A page that looks on: it is sent the newest state, and skips those for which it is too slow."""

    def __init__(self, socket: web.WebSocketResponse, transport: asyncio.Transport) -> None:
        self.socket, self.transport = socket, transport
        self._newest, self._due, self._first = "", asyncio.Event(), deque[str](maxlen=8)
        self._may_say, self._said_at = BURST, 0.0

    def show(self, state: str) -> None:
        """A newer state takes the place of one that was not sent."""
        self._newest = state
        self._due.set()

    def tell(self, message: str) -> None:
        """What is sent before the next state."""
        self._first.append(message)
        self._due.set()

    async def send(self) -> None:
        """Send what there is until the page is gone; one that takes nothing is let go."""
        try:
            while not self.socket.closed:
                await self._due.wait()
                self._due.clear()
                waiting = [self._first.popleft() for _ in range(len(self._first))]
                newest, self._newest = self._newest, ""
                for message in (*waiting, *filter(None, [newest])):
                    async with asyncio.timeout(STALE):
                        await self.socket.send_str(message)
        except (ConnectionError, TimeoutError):
            self.transport.abort()

    async def hear(self, act: Callable[[messages.Said], None]) -> None:
        """Let `act` have all that the page says, until it is gone; what is none of it, or a flood, ends its line."""
        said = 0
        async for message in self.socket:
            said += 1
            if said % AT_ONCE == 0:
                await asyncio.sleep(0)
            if self._floods(time.monotonic()):
                return await self.dismiss(WSCloseCode.POLICY_VIOLATION, f"over {MOST_SAID:g} messages a second")
            if message.type == WSMsgType.PING:
                await self.socket.pong(message.data)
            elif message.type == WSMsgType.TEXT:
                try:
                    act(messages.parse(message.data))
                except ValueError as error:
                    return await self.dismiss(WSCloseCode.POLICY_VIOLATION, str(error))
            elif message.type != WSMsgType.PONG:
                return await self.dismiss(WSCloseCode.UNSUPPORTED_DATA, "a message that is no text")

    def _floods(self, now: float) -> bool:
        """Whether one more message `now` [s] is too many."""
        self._may_say = min(self._may_say + MOST_SAID * (now - self._said_at), BURST) - 1.0
        self._said_at = now
        return self._may_say < 0.0

    async def dismiss(self, code: int, why: str) -> None:
        """Close the line, without listening to what is still being said."""
        self.transport.pause_reading()
        await self.socket.close(code=code, message=why.encode()[:120])
        self.transport.abort()
