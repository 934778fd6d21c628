"""A game of the arena with those who look on: what they say goes into it, and what there is to see goes to them."""

from __future__ import annotations

import asyncio
import secrets
import time
from collections import deque

from aiohttp import WSCloseCode, WSMsgType, web

from sim2real.arena import messages
from sim2real.arena.game import PERSON, TICKS, Game
from sim2real.arena.ticking import Ticking

STATE_EVERY = 2  # ticks between two states, of which 60 a second are sent
MOST_SAID = 240  # messages a second that a page may send
STALE = 5.0  # s that one message may take to go out


class Listener:
    """A page that looks on: it is sent the newest state, and skips those for which it is too slow."""

    def __init__(self, socket: web.WebSocketResponse) -> None:
        self.socket = socket
        self._newest, self._due, self._first = "", asyncio.Event(), deque[str](maxlen=8)

    def show(self, state: str) -> None:
        """A newer state takes the place of one that was not sent."""
        self._newest = state
        self._due.set()

    def tell(self, message: str) -> None:
        """What is sent before the next state."""
        self._first.append(message)
        self._due.set()

    async def send(self) -> None:
        """Send what there is until the page is gone, or takes nothing."""
        while not self.socket.closed:
            await self._due.wait()
            self._due.clear()
            waiting = [self._first.popleft() for _ in range(len(self._first))]
            newest, self._newest = self._newest, ""
            for message in (*waiting, *filter(None, [newest])):
                await asyncio.wait_for(self.socket.send_str(message), STALE)


class Session:
    """A game, its clock and its listeners; `id` is known to those who joined, and lets them come back."""

    def __init__(self, names: tuple[str, str], seed: int) -> None:
        """ValueError, in one line, for an unknown player."""
        self.id, self.names, self._seed = secrets.token_urlsafe(9), names, seed
        self.game = Game(names, seed)
        self.listeners: set[Listener] = set()
        self.left_at = time.monotonic()  # when the last listener went
        self._aim = 0.0
        self.ticking = Ticking(self._tick, TICKS)
        self._task = asyncio.create_task(self.ticking.run())

    def _tick(self) -> None:
        if not self.listeners:
            return  # a game that nobody sees stands still
        self.game.tick()
        if self.game.ticks % STATE_EVERY == 0 or self.game.over:
            state = messages.state(self.game.view(), self._aim)
            for listener in self.listeners:
                listener.show(state)

    async def serve(self, socket: web.WebSocketResponse) -> None:
        """Let a page look on, and play if there is a person's seat, until it is gone."""
        listener = Listener(socket)
        listener.tell(self._welcome())
        self.listeners.add(listener)
        sender = asyncio.create_task(listener.send())
        try:
            await self._hear(listener)
        finally:
            sender.cancel()
            self.listeners.discard(listener)
            self.left_at = time.monotonic()

    async def _hear(self, listener: Listener) -> None:
        second, said = 0, 0
        async for message in listener.socket:
            now = int(time.monotonic())
            second, said = now, said + 1 if now == second else 1
            if message.type != WSMsgType.TEXT or said > MOST_SAID:
                await listener.socket.close(code=WSCloseCode.POLICY_VIOLATION, message=b"too much, or not text")
                return
            try:
                self._act_on(messages.parse(message.data), listener)
            except ValueError as error:
                await listener.socket.close(code=WSCloseCode.POLICY_VIOLATION, message=str(error).encode()[:120])
                return

    def _act_on(self, said: messages.Said, listener: Listener) -> None:
        if isinstance(said, messages.Ping):
            listener.tell(messages.told("pong", sent=said.sent))
        elif isinstance(said, messages.Aim) and self.game.person is not None:
            self.game.person.aim(said.x, said.y)
            self._aim = said.sent
        elif isinstance(said, messages.Again) and self.game.over:
            self._seed += 1
            self.game = Game(self.names, self._seed)
            for each in self.listeners:
                each.tell(self._welcome())

    def _welcome(self) -> str:
        p = self.game.tables.params[0]
        sizes = ("length", "width", "goal_width", "puck_radius", "mallet_radius")
        return messages.told(
            "welcome", id=self.id, names=list(self.names), table={name: float(p[name]) for name in sizes},
            seat=self.names.index(PERSON) if PERSON in self.names else None,
        )  # fmt: skip

    def close(self) -> None:
        """End the game."""
        self._task.cancel()
        self.game.tables.close()
