"""Who comes finds a game, and the games that go on do not wait while one is made."""

from __future__ import annotations

import asyncio
import time
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("aiohttp", reason="it comes with pip install '.[test]'")
from aiohttp.test_utils import TestClient, TestServer

from sim2real.arena import lobby as lobby_module
from sim2real.arena.game import PERSON, Game
from sim2real.arena.lobby import Lobby
from sim2real.arena.recordings.records import Records
from sim2real.arena.server import make_app
from sim2real.arena.session import Session
from tests.sim2real.arena.test_server import TOKEN, heard, joined

SLOW = 0.8  # s that a game takes to be made


MADE: list[int] = []  # seeds of the games


def slow(names: tuple[str, str], seed: int) -> Game:
    MADE.append(seed)
    time.sleep(SLOW)
    return Game(names, seed)


def lobby_of(names: tuple[str, str], folder: Path, make_game: Any) -> tuple[Any, Lobby]:
    records = Records(folder)
    lobby = Lobby(names, 0, records, lambda seed, lateness: Session(names, seed, records, lateness, make_game))
    return make_app(lobby, records, TOKEN), lobby


async def longest_wait(socket: Any, until: float) -> float:
    """The longest wait [s] for a state until a time of the loop's clock."""
    clock = asyncio.get_running_loop()
    longest, now = 0.0, clock.time()
    while now < until:
        before = now
        await heard(socket, "state")
        now = clock.time()
        longest = max(longest, now - before)
    return longest


def test_a_game_goes_on_while_others_are_made(tmp_path: Path) -> None:
    async def play() -> None:
        app, lobby = lobby_of((PERSON, "still"), tmp_path, slow)
        async with TestClient(TestServer(app)) as client:
            playing = await joined(client)
            await heard(playing, "state")
            coming = asyncio.create_task(joined(client))
            assert await longest_wait(playing, asyncio.get_running_loop().time() + SLOW) < 0.5 * SLOW
            comes = await coming
            await heard(comes, "state")
            other = next(one for one in lobby._sessions.values() if one.game.ticks < 60)
            other.game.over = True  # by whatever ended it
            for _ in range(2):  # is being made the second time, and is not made twice
                await comes.send_str('{"kind":"again"}')
            assert await longest_wait(playing, asyncio.get_running_loop().time() + SLOW) < 0.5 * SLOW
            await heard(comes, "welcome")
            await asyncio.sleep(0.5 * SLOW)
            assert MADE == [1000, 2000, 2001]

    MADE.clear()
    asyncio.run(asyncio.wait_for(play(), 60.0))


def test_all_who_come_at_once_watch_one_game(tmp_path: Path) -> None:
    async def watch() -> None:
        app, lobby = lobby_of(("still", "goalie"), tmp_path, slow)
        async with TestClient(TestServer(app)) as client:
            for socket in await asyncio.gather(joined(client), joined(client), joined(client)):
                await heard(socket, "state")
            assert lobby.games == 1 and lobby.watchers == 3

    asyncio.run(asyncio.wait_for(watch(), 60.0))


def test_a_match_that_cannot_be_made_ends_the_game(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    made = []

    def once(names: tuple[str, str], seed: int) -> Game:
        made.append(seed)
        if len(made) > 1:
            raise RuntimeError("no more of it")
        return Game(names, seed)

    async def play() -> None:
        app, lobby = lobby_of((PERSON, "still"), tmp_path, once)
        async with TestClient(TestServer(app)) as client:
            socket = await joined(client)
            await heard(socket, "state")
            next(iter(lobby._sessions.values())).game.over = True
            await socket.send_str('{"kind":"again"}')
            while not socket.closed:
                await socket.receive()
            assert socket.close_code == Session.failure

    asyncio.run(asyncio.wait_for(play(), 60.0))
    assert "a game stopped, RuntimeError: no more of it" in capfd.readouterr().err


def test_a_game_that_is_left_is_completed_without_another_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    async def play() -> None:
        app, lobby = lobby_of((PERSON, "still"), tmp_path, Game)
        async with TestClient(TestServer(app)) as client:
            socket = await joined(client)
            await heard(socket, "state")
            await socket.close()
            for _ in range(100):
                if not lobby.games and any(tmp_path.glob("[!.]*/frames.csv")):
                    return
                await asyncio.sleep(0.1)
            pytest.fail("the game goes on")

    monkeypatch.setattr(lobby_module, "KEPT", 0.2)
    asyncio.run(asyncio.wait_for(play(), 60.0))
