"""The server lets those in who know the token, from its own page, and bears with those who mean harm."""

from __future__ import annotations

import asyncio
import contextlib
import json
import tempfile
from collections.abc import Awaitable, Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest

aiohttp = pytest.importorskip("aiohttp", reason="it comes with pip install '.[test]'")
from aiohttp.test_utils import TestClient, TestServer  # noqa: E402

import sim2real  # noqa: E402
from baselines.players.goalie import Goalie  # noqa: E402
from sim2real.arena import lobby as lobby_module  # noqa: E402
from sim2real.arena.game import PERSON, Game, concealed_game  # noqa: E402
from sim2real.arena.listener import BURST as MOST_SAID  # noqa: E402
from sim2real.arena.lobby import Lobby  # noqa: E402
from sim2real.arena.recordings.records import Records  # noqa: E402
from sim2real.arena.server import PAGE, make_app  # noqa: E402
from sim2real.arena.session import MakeGame, Session  # noqa: E402

TOKEN = "a-token"
Check = Callable[[Any, Lobby], Awaitable[None]]


def served(check: Check, names: tuple[str, str] = (PERSON, "still"), make_game: MakeGame = Game) -> None:
    """Run a check against a server of the test's own."""

    async def run() -> None:
        records = Records(folder)
        lobby = Lobby(names, 0, records, lambda seed, late: Session(names, seed, records, late, make_game))
        async with TestClient(TestServer(make_app(lobby, records, TOKEN))) as client:
            await check(client, lobby)

    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        asyncio.run(asyncio.wait_for(run(), 60.0))


async def joined(client: Any, **query: str) -> Any:
    origin = str(client.make_url("/")).rstrip("/")
    return await client.ws_connect("/game", params={"token": TOKEN, **query}, headers={"Origin": origin})


async def heard(socket: Any, kind: str) -> dict[str, Any]:
    """The next message of a kind."""
    while True:
        message = json.loads((await socket.receive()).data)
        if message["kind"] == kind:
            return message


def test_the_page_and_the_game_ask_for_the_token_and_the_game_for_its_own_page() -> None:
    async def check(client: Any, lobby: Lobby) -> None:
        assert (await client.get("/")).status == 403
        assert (await client.get("/", params={"token": "another"})).status == 403
        page = await client.get("/", params={"token": TOKEN})
        assert page.status == 200 and "script-src 'self'" in page.headers["Content-Security-Policy"]
        assert (await client.get("/main.js")).content_type == "text/javascript"
        for path in ("/../server.py", "/%2e%2e/server.py", "/server.py"):
            assert (await client.get(path)).status == 404
        for origin in ("http://elsewhere.example", None):
            headers = {"Origin": origin} if origin else {}
            with pytest.raises(aiohttp.WSServerHandshakeError, match="403"):
                await client.ws_connect("/game", params={"token": TOKEN}, headers=headers)

    served(check)


def test_a_person_aims_and_the_state_says_by_which_aim() -> None:
    async def check(client: Any, lobby: Lobby) -> None:
        socket = await joined(client)
        assert (await heard(socket, "welcome"))["seat"] == 0
        await socket.send_str('{"kind":"ping","sent":5}')
        assert (await heard(socket, "pong"))["sent"] == 5
        await socket.send_str('{"kind":"aim","x":0.3,"y":0.2,"sent":77}')
        while (state := await heard(socket, "state"))["aim"] != 77 or state["time"] < 1.0:
            pass
        assert state["mallets"][0] == pytest.approx([0.3, 0.2], abs=0.01)

    served(check)


@pytest.mark.parametrize(
    ("make_game", "notice"),
    [
        (Game, ""),
        (partial(Game, quick=True), "your mallet is quick; this match is not rated"),
        (concealed_game, "the table has an effect, or none: guess, and diagnose the replay; this match is not rated"),
    ],
)
def test_the_page_says_in_what_a_match_differs(make_game: MakeGame, notice: str) -> None:
    async def check(client: Any, lobby: Lobby) -> None:
        assert (await heard(await joined(client), "welcome"))["notice"] == notice

    served(check, make_game=make_game)


def test_who_comes_back_finds_the_same_game_where_it_stood() -> None:
    async def check(client: Any, lobby: Lobby) -> None:
        socket = await joined(client)
        first = (await heard(socket, "welcome"))["id"]
        time = (await heard(socket, "state"))["time"]
        await socket.close()
        await asyncio.sleep(0.5)  # nobody sees it
        again = await joined(client, id=first)
        assert (await heard(again, "welcome"))["id"] == first
        assert time < (await heard(again, "state"))["time"] < time + 0.4
        newest = await joined(client, id=first)  # while the one before is there, whose line may be dead
        assert (await heard(newest, "welcome"))["id"] == first
        while not again.closed:
            await again.receive()
        assert again.close_code == lobby_module.TAKEN_OVER
        assert (await heard(await joined(client), "welcome"))["id"] != first

    served(check)


class Stumbling(Goalie):
    """Fails at its third decision."""

    decisions = 0

    def act(self, observation: Any) -> Any:
        self.decisions += 1
        if self.decisions == 3:
            raise RuntimeError("it fell")
        return super().act(observation)


def test_a_player_that_fails_ends_its_game_with_a_word(capsys: pytest.CaptureFixture) -> None:
    async def check(client: Any, lobby: Lobby) -> None:
        socket = await joined(client)
        id_ = (await heard(socket, "welcome"))["id"]
        while not socket.closed:
            await socket.receive()
        assert socket.close_code == aiohttp.WSCloseCode.INTERNAL_ERROR
        assert (await heard(await joined(client), "welcome"))["id"] != id_

    served(check, (PERSON, f"{__name__}:Stumbling"))
    assert "puckpilot arena: a game stopped, RuntimeError: it fell" in capsys.readouterr().err


@pytest.mark.parametrize("said", ["{", '{"kind":"aim","x":1e9,"y":0,"sent":0}', "x" * 500, "x" * 100_000, b"\x00" * 10])
def test_nonsense_ends_its_own_connection_alone(said: str | bytes) -> None:
    async def check(client: Any, lobby: Lobby) -> None:
        good, bad = await joined(client), await joined(client)
        await heard(bad, "welcome")
        await (bad.send_bytes(said) if isinstance(said, bytes) else bad.send_str(said))
        while not bad.closed:
            await bad.receive()
        assert bad.close_code in (
            aiohttp.WSCloseCode.POLICY_VIOLATION,
            aiohttp.WSCloseCode.MESSAGE_TOO_BIG,
            aiohttp.WSCloseCode.UNSUPPORTED_DATA,
        )
        before = (await heard(good, "state"))["time"]
        while (await heard(good, "state"))["time"] < before + 0.2:
            pass

    served(check)


async def until_closed(socket: Any) -> None:
    """Listen until the other side closes."""
    while not socket.closed:
        await socket.receive()


@pytest.mark.parametrize("kind", ["text", "ping", "pong"])
def test_a_flood_ends_its_own_connection_and_another_game_goes_on(kind: str) -> None:
    async def check(client: Any, lobby: Lobby) -> None:
        good, bad = await joined(client), await joined(client)
        say = {"text": lambda: bad.send_str('{"kind":"ping","sent":1}'), "ping": bad.ping, "pong": bad.pong}[kind]
        said, gone = 0, asyncio.create_task(until_closed(bad))
        with contextlib.suppress(ConnectionError):
            while said < 100 * MOST_SAID and not gone.done():
                await say()
                said += 1
                if said % 50 == 0:
                    await asyncio.sleep(0.001)
        await gone
        assert said < 100 * MOST_SAID
        before = (await heard(good, "state"))["time"]
        while (await heard(good, "state"))["time"] < before + 0.2:
            pass

    served(check)


def test_a_full_arena_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lobby_module, "MOST_SESSIONS", 2)

    async def check(client: Any, lobby: Lobby) -> None:
        sockets = [await joined(client) for _ in range(3)]
        message = await sockets[2].receive()
        assert message.type == aiohttp.WSMsgType.CLOSE and message.extra == "the arena is full"
        assert (await heard(sockets[1], "welcome"))["kind"] == "welcome"

    served(check)


def test_a_game_whose_person_does_not_come_back_is_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lobby_module, "KEPT", 0.0)

    async def check(client: Any, lobby: Lobby) -> None:
        first = await joined(client)
        id_ = (await heard(first, "welcome"))["id"]
        await first.close()
        await asyncio.sleep(0.1)
        assert (await heard(await joined(client, id=id_), "welcome"))["id"] != id_

    served(check)


def test_all_watch_one_game_of_two_players() -> None:
    async def check(client: Any, lobby: Lobby) -> None:
        one, other = await joined(client), await joined(client)
        first, second = await heard(one, "welcome"), await heard(other, "welcome")
        assert first == second and "id" not in first and first["seat"] is None and first["names"] == ["still", "goalie"]
        while (await heard(one, "state"))["time"] < 0.1:
            pass

    served(check, ("still", "goalie"))


def test_the_page_is_light_and_its_code_short() -> None:
    files = list(PAGE.iterdir())
    assert sum(file.stat().st_size for file in files) < 150_000
    assert sum(len(file.read_text(encoding="utf-8").splitlines()) for file in files if file.suffix == ".js") < 1500


def test_a_recording_is_for_those_who_know_the_token_and_its_name(tmp_path: Path) -> None:
    demo = Path(sim2real.__file__).with_name("demo_recording")
    (broken := tmp_path / "broken").mkdir()
    (broken / "meta.json").write_text("{}")

    async def run() -> None:
        records = Records(tmp_path / "out", [demo, broken])
        async with TestClient(TestServer(make_app(Lobby((PERSON, "still"), 0, records), records, TOKEN))) as client:
            assert (await client.get("/replay")).status == 403
            assert (await client.get("/replay", params={"token": TOKEN})).status == 200
            assert (await client.get("/recording", params={"name": demo.name})).status == 403
            gone = await client.get("/recording", params={"name": "../demo_recording", "token": TOKEN})
            assert gone.status == 404 and "no recording '../demo_recording'" in await gone.text()
            bad = await client.get("/recording", params={"name": "broken", "token": TOKEN})
            assert bad.status == 422 and "format" in await bad.text()
            found = await (await client.get("/recording", params={"name": demo.name, "token": TOKEN})).json()
            assert found["name"] == demo.name and len(found["glides"]) > 10 and len(found["contacts"]) > 10

    asyncio.run(asyncio.wait_for(run(), 120.0))


def test_a_match_that_is_over_says_where_its_recording_is() -> None:
    async def check(client: Any, lobby: Lobby) -> None:
        socket = await joined(client)
        welcome = await heard(socket, "welcome")
        session = lobby._sessions[welcome["id"]]
        session.game.tables.states["steps"] = 180 * 120 - 20  # of a match of three minutes
        name = (await heard(socket, "recorded"))["name"]
        assert name.endswith("_human-guest_still")
        assert (await heard(await joined(client, id=welcome["id"]), "recorded"))["name"] == name
        await socket.close()

    served(check)
