"""All games of the arena: one for each person, or one that all watch, within limits."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable

from aiohttp import WSCloseCode, web

from sim2real.arena.game import PERSON
from sim2real.arena.recordings.records import Records
from sim2real.arena.session import Session
from sim2real.arena.ticking import Lateness

MOST_SESSIONS = 8
MOST_WATCHERS = 64
# Codes with which a page is let go that does not come back: another page has its game, or it ended
TAKEN_OVER, GONE = 4001, 4002
# With a seed, in any thread; steps are counted with those of the other games
Begin = Callable[[int, Lateness], Session]
KEPT = 30.0  # s that a game waits for its person to come back


class RefusedError(Exception):
    """A page cannot get in: the `code` and reason with which it is let go."""

    def __init__(self, code: int, why: str) -> None:
        super().__init__(why)
        self.code = code


class Lobby:
    """Games of the same two names; where one is a person each page has its own, else all watch one."""

    def __init__(self, names: tuple[str, str], seed: int, records: Records, begin: Begin | None = None) -> None:
        """begin: makes the session of a game with a seed; by default, one of the names."""
        self._names, self._seed = names, seed
        self._begin = begin or (lambda seed, lateness: Session(names, seed, records, lateness))
        self._sessions: dict[str, Session] = {}
        self._making = asyncio.Lock()  # one session at a time, so that all who watch find the same
        self._ending: set[asyncio.Task[None]] = set()
        self.lateness = Lateness()  # of all games

    async def join(
        self, socket: web.WebSocketResponse, transport: asyncio.Transport, known: str, watch: str = ""
    ) -> None:
        """Let a page into its game until it is gone: the one that it knows by its id, or another; or one that it
        watches. RefusedError if that cannot be. A person's game that is known by its id is taken over from the page
        that had it, whose line may be dead."""
        self._forget()
        plays = PERSON in self._names and not watch
        if not plays and self.watchers >= MOST_WATCHERS:
            raise RefusedError(WSCloseCode.TRY_AGAIN_LATER, "the arena is full")
        session = self._watched(watch) if watch else await self._session(known)
        if plays:
            session.free_seat(TAKEN_OVER, "this game goes on in another page")
        try:
            await session.serve(socket, transport, plays)
        finally:
            asyncio.get_running_loop().call_later(KEPT + 1.0, self._forget)

    @property
    def games(self) -> int:
        """How many there are."""
        return len(self._sessions)

    @property
    def watchers(self) -> int:
        """How many pages look on, and do not play."""
        return sum(session.watchers for session in self._sessions.values())

    def _watched(self, name: str) -> Session:
        for session in self._sessions.values():
            if session.watched_as == name:
                return session
        raise RefusedError(GONE, "there is no such game any more")

    async def _session(self, known: str) -> Session:
        async with self._making:
            for session in self._sessions.values():
                if session.id == known or PERSON not in self._names:
                    return session
            if len(self._sessions) >= MOST_SESSIONS:
                raise RefusedError(WSCloseCode.TRY_AGAIN_LATER, "the arena is full")
            self._seed = (self._seed + 1000) % (1 << 63)
            session = await asyncio.to_thread(self._begin, self._seed, self.lateness)  # while the others play
            session.start()
            self._sessions[session.id] = session
            return session

    def _forget(self) -> None:
        """End games whose person did not come back."""
        now = time.monotonic()
        for session in list(self._sessions.values()):
            if session.failed or (not session.is_seen and now - session.left_at > KEPT):
                session.dismiss(session.listeners, GONE, "the game ended")
                self._end(session)

    def _end(self, session: Session) -> None:
        """End a game beside the others."""
        del self._sessions[session.id]
        task = asyncio.create_task(session.close())
        self._ending.add(task)
        task.add_done_callback(self._ending.discard)

    async def close(self) -> None:
        """End all games."""
        for session in list(self._sessions.values()):
            self._end(session)
        await asyncio.gather(*self._ending)
