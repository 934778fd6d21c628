"""A game of the arena with those who look on: what they say goes into it, and what there is to see goes to them."""

from __future__ import annotations

import asyncio
import secrets
import sys
import time
from collections import deque
from collections.abc import Coroutine

from aiohttp import WSCloseCode, WSMsgType, web

from sim2real.arena import messages
from sim2real.arena.game import PERSON, TICKS, Game
from sim2real.arena.recordings.game_recorder import GameRecorder
from sim2real.arena.recordings.records import Records
from sim2real.arena.ticking import Ticking

STATE_EVERY = 2  # ticks between two states, of which 60 a second are sent
MOST_SAID = 240  # messages a second that a page may send
STALE = 5.0  # s that one message may take to go out


class Listener:
    """A page that looks on: it is sent the newest state, and skips those for which it is too slow."""

    def __init__(self, socket: web.WebSocketResponse, transport: asyncio.Transport) -> None:
        self.socket, self.transport = socket, transport
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

    async def dismiss(self, code: int, why: str) -> None:
        """Close the line, without listening to what is still being said."""
        self.transport.pause_reading()
        await self.socket.close(code=code, message=why.encode()[:120])
        self.transport.abort()


class Session:
    """A game, its clock and its listeners; `id` is known to those who joined, and lets them come back."""

    def __init__(self, names: tuple[str, str], seed: int, records: Records) -> None:
        """ValueError, in one line, for an unknown player."""
        self.id, self.names, self._seed, self._records = secrets.token_urlsafe(9), names, seed, records
        self.game = Game(names, seed)
        self.listeners: set[Listener] = set()
        self.left_at = time.monotonic()  # when the last listener went
        self.failed = False  # whether it stopped because a player failed
        self._recorder: GameRecorder | None = None  # once there is something to record
        self._recorded = ""  # the name of the recording, once it is complete
        self._aim = 0.0
        self.ticking = Ticking(self._tick, TICKS)
        self._task = asyncio.create_task(self.ticking.run())
        self._task.add_done_callback(self._stopped)
        self._beside: set[asyncio.Task[None]] = set()

    def _tick(self) -> None:
        if not self.listeners or self.game.over:
            return  # a game that nobody sees stands still
        if self._recorder is None:
            self._recorder = self._records.begin(self.game, self._seed)
        self.game.tick()
        view = self.game.view()
        self._recorder.add(view)
        if self.game.ticks % STATE_EVERY == 0 or self.game.over:
            state = messages.state(view, self._aim)
            for listener in self.listeners:
                listener.show(state)
        if self.game.over:
            self._do(self._keep(self._recorder, self.game, self._seed))

    async def _keep(self, recorder: GameRecorder, game: Game, seed: int) -> None:
        """Complete the recording of a match that is over, and say where it is."""
        try:
            await asyncio.to_thread(self._records.keep, recorder, game, seed)
        except (OSError, ValueError) as error:
            return _lost(error)
        if game is self.game:
            self._recorded = recorder.name
            for listener in self.listeners:
                listener.tell(messages.encode("recorded", name=recorder.name))

    def _do(self, work: Coroutine[None, None, None]) -> None:
        """Let something go on beside the game."""
        task = asyncio.create_task(work)
        self._beside.add(task)
        task.add_done_callback(self._beside.discard)

    def _stopped(self, task: asyncio.Task[None]) -> None:
        """Say why the game stopped, if a player failed in it, and let the pages go."""
        if task.cancelled() or (error := task.exception()) is None:
            return
        print(f"puckpilot arena: a game stopped, {type(error).__name__}: {error}", file=sys.stderr, flush=True)
        self.failed = True
        self.dismiss_all(WSCloseCode.INTERNAL_ERROR, "a player failed")

    def dismiss_all(self, code: int, why: str) -> None:
        """Let all pages go."""
        for listener in self.listeners:
            self._do(listener.dismiss(code, why))

    async def serve(self, socket: web.WebSocketResponse, transport: asyncio.Transport) -> None:
        """Let a page look on, and play if there is a person's seat, until it is gone."""
        listener = Listener(socket, transport)
        listener.tell(self._welcome())
        if self._recorded:
            listener.tell(messages.encode("recorded", name=self._recorded))
        listener.show(messages.state(self.game.view(), self._aim))
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
            if said > MOST_SAID:
                return await listener.dismiss(WSCloseCode.POLICY_VIOLATION, f"over {MOST_SAID} messages in a second")
            if message.type == WSMsgType.PING:
                await listener.socket.pong(message.data)
            elif message.type == WSMsgType.TEXT:
                try:
                    self._act_on(messages.parse(message.data), listener)
                except ValueError as error:
                    return await listener.dismiss(WSCloseCode.POLICY_VIOLATION, str(error))
            elif message.type != WSMsgType.PONG:
                return await listener.dismiss(WSCloseCode.UNSUPPORTED_DATA, "a message that is no text")

    def _act_on(self, said: messages.Said, listener: Listener) -> None:
        if isinstance(said, messages.Ping):
            listener.tell(messages.encode("pong", sent=said.sent))
        elif isinstance(said, messages.Aim) and self.game.person is not None:
            self.game.person.aim(said.x, said.y)
            self._aim = said.sent
        elif isinstance(said, messages.Again) and self.game.over:
            self._seed += 1
            self.game, self._recorder, self._recorded = Game(self.names, self._seed), None, ""
            for each in self.listeners:
                each.tell(self._welcome())

    def _welcome(self) -> str:
        p = self.game.tables.params[0]
        sizes = ("length", "width", "goal_width", "puck_radius", "mallet_radius")
        return messages.encode(
            "welcome", id=self.id, names=list(self.names), table={name: float(p[name]) for name in sizes},
            seat=self.names.index(PERSON) if PERSON in self.names else None,
        )  # fmt: skip

    def close(self) -> None:
        """End the game; what was played of it is a recording."""
        self._task.cancel()
        try:
            if self._recorder is not None and not self.game.over:
                self._recorder.finish()
        except (OSError, ValueError) as error:
            _lost(error)
        self.game.tables.close()


def _lost(error: Exception) -> None:
    """Say that a game is no recording; its draft stays."""
    print(f"puckpilot arena: a game is not recorded, {error}", file=sys.stderr, flush=True)
