"""All games of the arena: one for each person, or one that all watch, within limits."""

from __future__ import annotations

import asyncio
import time

from aiohttp import web

from sim2real.arena.game import PERSON
from sim2real.arena.recordings.records import Records
from sim2real.arena.session import Session

MOST_SESSIONS = 8
MOST_LISTENERS = 64
TAKEN_OVER = 4001  # code with which a page is let go whose game another one has; it does not come back
KEPT = 30.0  # s that a game waits for its person to come back


class FullError(Exception):
    """There is no room for another."""


class Lobby:
    """Games of the same two names; where one is a person each page has its own, else all watch one."""

    def __init__(self, names: tuple[str, str], seed: int, records: Records) -> None:
        self._names, self._seed, self._records = names, seed, records
        self._sessions: dict[str, Session] = {}

    async def join(self, socket: web.WebSocketResponse, transport: asyncio.Transport, known: str) -> None:
        """Let a page into its game, the one that it knows by its id or another, until it is gone. FullError where there
        are too many. A person's game that is known by its id is taken over from the page that had it, whose line may be
        dead."""
        if sum(len(session.listeners) for session in self._sessions.values()) >= MOST_LISTENERS:
            raise FullError
        session = self._session(known)
        if PERSON in self._names:
            session.dismiss_all(TAKEN_OVER, "this game goes on in another page")
        await session.serve(socket, transport)

    def _session(self, known: str) -> Session:
        self._forget()
        for session in self._sessions.values():
            if session.id == known or PERSON not in self._names:
                return session
        if len(self._sessions) >= MOST_SESSIONS:
            raise FullError
        self._seed = (self._seed + 1000) % (1 << 63)
        session = Session(self._names, self._seed, self._records)
        self._sessions[session.id] = session
        return session

    def _forget(self) -> None:
        """End games whose person did not come back."""
        now = time.monotonic()
        for session in list(self._sessions.values()):
            if session.failed or (not session.listeners and now - session.left_at > KEPT):
                self._sessions.pop(session.id).close()

    def close(self) -> None:
        """End all games."""
        while self._sessions:
            self._sessions.popitem()[1].close()
