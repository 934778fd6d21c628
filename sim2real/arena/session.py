"""A game of the arena with those who look on: what a person says goes into it, and what there is to see goes to all."""

from __future__ import annotations

import asyncio
import secrets
import sys
import time
from collections.abc import Callable, Coroutine

from aiohttp import WSCloseCode, web

from sim2real.arena import messages
from sim2real.arena.game import PERSON, TICKS, Game
from sim2real.arena.listener import Listener
from sim2real.arena.recordings.game_recorder import GameRecorder
from sim2real.arena.recordings.records import Records
from sim2real.arena.ticking import Lateness, Ticking

STATE_EVERY = 2  # ticks between two states, of which 60 a second are sent
MakeGame = Callable[[tuple[str, str], int], Game]  # of both names and a seed


class Session:
    """A game, its clock and its listeners; `id` is known to the page that plays, and lets it come back; `watched_as` to
    those who look on. Its game can be made in any thread, all else happens in the loop's, from `start` on."""

    again = True  # whether a page may ask for another match
    failure: int = WSCloseCode.INTERNAL_ERROR  # with which pages are let go where a player failed: they come back

    def __init__(
        self,
        names: tuple[str, str],
        seed: int,
        records: Records,
        lateness: Lateness | None = None,
        make_game: MakeGame = Game,
    ) -> None:
        """ValueError, in one line, for an unknown player."""
        self.id, self.watched_as = secrets.token_urlsafe(9), secrets.token_urlsafe(6)
        self.names, self._seed, self._records, self._make_game = names, seed, records, make_game
        self.game = make_game(names, seed)
        self.listeners: set[Listener] = set()
        self._player: Listener | None = None  # that sits at the person's seat
        self.left_at = time.monotonic()  # when the last listener went, or who plays
        self.failed = False  # whether it stopped because a player failed
        self._recorder: GameRecorder | None = None
        self._looked = False  # whether there is a recorder, or room for none
        self._recorded = ""  # the name of the recording, once it is complete
        self._ticking = Ticking(self._tick, TICKS, lateness)
        self._task: asyncio.Task[None] | None = None
        self._beside: set[asyncio.Task[None]] = set()
        self._making = False  # whether another match is being made
        self._closed = False

    def start(self) -> None:
        """Let the clock go, from now on."""
        self._task = asyncio.create_task(self._ticking.run())
        self._task.add_done_callback(self._stopped)

    @property
    def is_seen(self) -> bool:
        """Whether who plays is there, or who looks on where two players play; else the game stands still."""
        return self._player is not None if PERSON in self.names else bool(self.listeners)

    @property
    def watchers(self) -> int:
        """How many pages look on, and do not play."""
        return len(self.listeners - {self._player})

    def _tick(self) -> None:
        if not self.is_seen or self.game.over:
            return
        if not self._looked:
            self._begin_recording()
        self.game.tick()
        self._record()
        if self.game.ticks % STATE_EVERY == 0 or self.game.over:
            state = self._state()
            for listener in self.listeners:
                listener.show(state)
        if self.game.over:
            self._do(self._keep(self._recorder, self.game, self._seed))

    def _state(self) -> str:
        person = self.game.person
        return messages.state(self.game.view(), {} if person is None else person.followed())

    def _begin_recording(self) -> None:
        """Begin the recording, if there is room for it."""
        self._looked = True
        try:
            self._recorder = self._records.begin(self.game, self._seed)
        except (OSError, ValueError) as error:
            _lost(error)

    def _record(self) -> None:
        """Record what there is to see, as long as that can be: the game goes on in any case."""
        try:
            if self._recorder is not None:
                self._recorder.add(self.game)
        except (OSError, ValueError) as error:
            self._recorder = None
            _lost(error)

    async def _keep(self, recorder: GameRecorder | None, game: Game, seed: int) -> None:
        """Note how a match ended that is over, complete its recording if there is one, and say where it is."""
        try:
            await asyncio.to_thread(self._records.keep, recorder, game, seed)
        except (OSError, ValueError) as error:
            return _lost(error)
        if recorder is not None and game is self.game:
            self._recorded = recorder.name
            for listener in self.listeners:
                listener.tell(messages.encode("recorded", name=recorder.name))

    def _do(self, work: Coroutine[None, None, None]) -> None:
        """Let something go on beside the game."""
        task = asyncio.create_task(work)
        self._beside.add(task)
        task.add_done_callback(self._beside.discard)

    def _stopped(self, task: asyncio.Task[None]) -> None:
        if not task.cancelled() and (error := task.exception()) is not None:
            self._fail(error)

    def _fail(self, error: BaseException) -> None:
        """Say why the game stopped, for a player failed in it, and let the pages go."""
        print(f"puckpilot arena: a game stopped, {type(error).__name__}: {error}", file=sys.stderr, flush=True)
        self.failed = True
        self.dismiss(self.listeners, self.failure, "a player failed")

    def dismiss(self, listeners: set[Listener], code: int, why: str) -> None:
        """Let pages go."""
        for listener in listeners:
            self._do(listener.dismiss(code, why))

    def free_seat(self, code: int, why: str) -> None:
        """Let the page go that plays, if one does: another one comes."""
        if self._player is not None:
            self.dismiss({self._player}, code, why)
        self._player = None
        if self.game.person is not None:
            self.game.person.forget_stamp()

    async def serve(self, socket: web.WebSocketResponse, transport: asyncio.Transport, plays: bool) -> None:
        """Let a page look on, and play at the person's seat if it `plays`, until it is gone."""
        listener = Listener(socket, transport)
        self.listeners.add(listener)
        if plays:
            self._player = listener
        for message in self._greeting(listener):
            listener.tell(message)
        listener.show(self._state())
        sender = asyncio.create_task(listener.send())
        try:
            await listener.hear(lambda said: self._act_on(said, listener))
        finally:
            sender.cancel()
            was_seen = self.is_seen
            self.listeners.discard(listener)
            if listener is self._player:
                self._player = None
            if was_seen and not self.is_seen:
                self.left_at = time.monotonic()

    def _act_on(self, said: messages.Said, listener: Listener) -> None:
        if isinstance(said, messages.Ping):
            listener.tell(messages.encode("pong", sent=said.sent))
        elif PERSON in self.names and listener is not self._player:
            return  # who looks on does not play
        elif isinstance(said, messages.Aim) and self.game.person is not None:
            self.game.person.aim(said.x, said.y, said.sent)
        elif isinstance(said, messages.Again) and self.game.over and self.again:
            self._do(self._begin(self.names, self._seed + 1))

    async def _begin(self, names: tuple[str, str], seed: int) -> None:
        """Begin another match, unless one is being made; other games go on meanwhile."""
        if self._making:
            return
        self._making = True
        try:
            game = await asyncio.to_thread(self._make_game, names, seed)
        except Exception as error:
            return self._fail(error)
        finally:
            self._making = False
        if self._closed:
            return game.tables.close()
        self.game.tables.close()
        self.names, self._seed, self.game, self._recorder = names, seed, game, None
        self._looked, self._recorded = False, ""
        for each in self.listeners:
            each.tell(self._welcome(each))
            each.show(self._state())  # in place of the last one of the match before

    def _greeting(self, listener: Listener) -> list[str]:
        """What a page that comes is sent before the first state."""
        recorded = [messages.encode("recorded", name=self._recorded)] if self._recorded else []
        return [self._welcome(listener), *recorded]

    def _welcome(self, listener: Listener) -> str:
        own, person = {}, self.game.person
        again = self.again and (person is None or listener is self._player)
        if listener is self._player and person is not None:
            own = {"seat": self.names.index(PERSON), "id": self.id, "watch": self.watched_as, "law": person.law}
        names = [self._records.person if name == PERSON else name for name in self.names]
        return messages.welcome(self.game.tables.params[0], names, again, notice=_notice(self.game), **own)

    async def close(self) -> None:
        """End the game; what was played of it is a recording, and no other match begins."""
        self._closed = True
        if self._task is not None:
            self._task.cancel()
        try:
            if self._recorder is not None and not self.game.over:
                await asyncio.to_thread(self._records.leave, self._recorder)
        except (OSError, ValueError) as error:
            _lost(error)
        self.game.tables.close()


def _notice(game: Game) -> str:
    """In what a match differs from others."""
    what = [
        *(["the table has an effect, or none: guess, and diagnose the replay"] if game.concealed else []),
        *(["your mallet is quick"] if game.quick else []),
    ]
    return "; ".join([*what, "this match is not rated"]) if what else ""


def _lost(error: Exception) -> None:
    """Say that a game is no recording; its draft stays."""
    print(f"puckpilot arena: a game is not recorded, {error}", file=sys.stderr, flush=True)
