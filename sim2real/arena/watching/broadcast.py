"""A game of which the messages come from elsewhere, and those who watch it."""

from __future__ import annotations

import asyncio

from aiohttp import WSCloseCode, web

from sim2real.arena import messages
from sim2real.arena.listener import Listener
from sim2real.arena.lobby import GONE, MOST_WATCHERS, RefusedError


class Broadcast:
    """Passes a game's messages on to all who watch; who comes later begins with the newest."""

    def __init__(self) -> None:
        self._listeners: set[Listener] = set()
        self._welcome = self._state = ""

    def show(self, state: str) -> None:
        """Pass a state on, in place of one that was not sent yet."""
        self._state = state
        for listener in self._listeners:
            listener.show(state)

    def welcome(self, message: str) -> None:
        """Begin another match, with the message that welcomes pages."""
        self._welcome, self._state = message, ""
        for listener in self._listeners:
            listener.tell(message)

    async def join(self, socket: web.WebSocketResponse, transport: asyncio.Transport, known: str, watch: str) -> None:
        """Let a page watch until it is gone. RefusedError where there are too many."""
        if len(self._listeners) >= MOST_WATCHERS:
            raise RefusedError(WSCloseCode.TRY_AGAIN_LATER, "too many look on")
        listener = Listener(socket, transport)
        if self._welcome:
            listener.tell(self._welcome)
        if self._state:
            listener.show(self._state)
        self._listeners.add(listener)
        sender = asyncio.create_task(listener.send())
        try:
            await listener.hear(lambda said: _answer(said, listener))
        finally:
            sender.cancel()
            self._listeners.discard(listener)

    async def end(self) -> None:
        """Let all pages go, which need not come back."""
        await asyncio.gather(*(one.dismiss(GONE, "the game is over") for one in list(self._listeners)))

    async def close(self) -> None:
        """Nothing is left to end."""


def _answer(said: messages.Said, listener: Listener) -> None:
    """Whoever watches may ask how long an answer takes, and nothing else."""
    if isinstance(said, messages.Ping):
        listener.tell(messages.encode("pong", sent=said.sent))
