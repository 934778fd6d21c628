"""Friends look on at a person's game, and cannot take the seat."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest

aiohttp = pytest.importorskip("aiohttp", reason="it comes with pip install '.[test]'")

from sim2real.arena import lobby as lobby_module  # noqa: E402
from sim2real.arena.lobby import GONE, Lobby  # noqa: E402
from tests.sim2real.arena.test_server import TOKEN, heard, joined, served, until_closed  # noqa: E402


def test_who_looks_on_sees_the_game_and_cannot_play_it() -> None:
    async def check(client: Any, lobby: Lobby) -> None:
        player = await joined(client)
        welcome = await heard(player, "welcome")
        watcher = await joined(client, watch=welcome["watch"])
        seen = await heard(watcher, "welcome")
        assert seen["seat"] is None and seen["names"] == welcome["names"]
        assert "id" not in seen and "watch" not in seen and welcome["id"] not in str(seen)
        await watcher.send_str('{"kind":"aim","x":0.9,"y":0.9,"sent":5}')
        await watcher.send_str('{"kind":"again"}')
        await player.send_str('{"kind":"aim","x":0.3,"y":0.2,"sent":77}')
        while (state := await heard(watcher, "state"))["aim"] != 77 or state["age"] < 120:
            pass
        assert state["mallets"][0] == pytest.approx([0.3, 0.2], abs=0.01)
        again = await joined(client, id=welcome["id"])  # the player's page is loaded anew: friends stay
        await until_closed(player)
        assert (await heard(again, "state"))["aim"] == 0  # no stamp of another page's clock
        time = (await heard(watcher, "state"))["time"]
        await again.close()
        await asyncio.sleep(0.3)  # nobody plays: it stands still
        session = next(iter(lobby._sessions.values()))
        stands = session.game.ticks
        await asyncio.sleep(0.3)
        assert session.game.ticks == stands and stands / 120 > time - 0.1 and not watcher.closed

    served(check)


def test_a_game_that_is_over_for_good_or_never_was_cannot_be_watched(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lobby_module, "KEPT", 0.0)

    async def check(client: Any, lobby: Lobby) -> None:
        player = await joined(client)
        welcome = await heard(player, "welcome")
        watcher = await joined(client, watch=welcome["watch"])
        gone = asyncio.create_task(until_closed(watcher))
        await player.close()
        await asyncio.sleep(0.1)
        for wrong in (welcome["id"], welcome["watch"]):  # the first never was one to watch
            late = await joined(client, watch=wrong)
            await until_closed(late)
            assert late.close_code == GONE
        await gone
        assert watcher.close_code == GONE

    served(check)


def test_watchers_leave_room_for_players(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lobby_module, "MOST_WATCHERS", 2)

    async def check(client: Any, lobby: Lobby) -> None:
        watch = (await heard(await joined(client), "welcome"))["watch"]
        watchers = [await joined(client, watch=watch) for _ in range(3)]
        await until_closed(watchers[2])
        assert watchers[2].close_code == aiohttp.WSCloseCode.TRY_AGAIN_LATER
        assert (await heard(await joined(client), "welcome"))["seat"] == 0

    served(check)


def test_the_server_says_how_it_keeps_up() -> None:
    async def check(client: Any, lobby: Lobby) -> None:
        assert (await client.get("/health")).status == 403
        player = await joined(client)
        watch = (await heard(player, "welcome"))["watch"]
        await heard(await joined(client, watch=watch), "state")
        while (await heard(player, "state"))["time"] < 0.2:
            pass
        said = await (await client.get("/health", params={"token": TOKEN})).json()
        assert (said["games"], said["watchers"]) == (1, 1) and said["ticks"] >= 24
        assert said["latest_s"] > 0.0 and said["lost_s"] >= 0.0 and said["late_ticks"] <= said["ticks"]

    served(check)
