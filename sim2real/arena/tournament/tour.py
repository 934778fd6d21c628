"""A game of the arena in which several players meet in turn, one match after the other."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from dataclasses import asdict

from baselines.matches.played_games import Game as Played
from sim2real.arena import messages
from sim2real.arena.game import Game
from sim2real.arena.listener import Listener
from sim2real.arena.lobby import GONE
from sim2real.arena.recordings.game_recorder import GameRecorder
from sim2real.arena.recordings.records import Records
from sim2real.arena.session import Session
from sim2real.arena.ticking import Lateness
from sim2real.arena.tournament.schedule import next_match
from sim2real.arena.tournament.standings import standings

PAUSE = 10.0  # s between two matches, in which pages show the standings


class Tour(Session):
    """A session that goes on to the next match by itself. games: those that the players had so far, to which each
    match is added."""

    again = False
    failure = GONE  # what is deterministic fails again, so nobody comes back by itself

    def __init__(
        self, players: Sequence[str], games: list[Played], seed: int, records: Records, lateness: Lateness | None = None
    ) -> None:
        """ValueError, in one line, for an unknown player."""
        self._players, self._games, self._first_seed = players, games, seed
        self._standings = self._computed()
        super().__init__(*self._next(), records, lateness)

    def _next(self) -> tuple[tuple[str, str], int]:
        return next_match(self._players, self._games, self._first_seed)

    def _computed(self) -> str:
        """The standings as a message."""
        rows = [asdict(row) for row in standings(self._players, self._games)]
        return messages.encode("standings", rows=rows, next=self._next()[0])

    def _greeting(self, listener: Listener) -> list[str]:
        return [*super()._greeting(listener), self._standings]

    async def _keep(self, recorder: GameRecorder | None, game: Game, seed: int) -> None:
        await super()._keep(recorder, game, seed)
        self._games.append((game.names, game.view().score))
        self._standings = await asyncio.to_thread(self._computed)
        for listener in self.listeners:
            listener.tell(self._standings)
        await asyncio.sleep(PAUSE)
        if not self._closed:
            await self._begin(*self._next())
