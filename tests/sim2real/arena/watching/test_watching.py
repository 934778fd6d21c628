"""A game that is fed by another process is for those who know the token, and waits for nobody."""

from __future__ import annotations

import asyncio
import json
import socket
import subprocess
import sys
import time
from contextlib import closing
from typing import Any
from urllib.parse import parse_qs, urlsplit

import pytest

aiohttp = pytest.importorskip("aiohttp", reason="it comes with pip install '.[test]'")

from puckpilot_env.tables import Tables  # noqa: E402
from sim2real.arena import messages  # noqa: E402
from sim2real.arena.game import View  # noqa: E402
from sim2real.arena.lobby import GONE  # noqa: E402
from sim2real.arena.watching.feed import Feed  # noqa: E402

WELCOME = messages.welcome(Tables("match-v0", 1).params[0], ("one", "two"), False)


def state(time: float) -> str:
    return messages.state(View(time, (0.25, 0.5), ((0.3, 0.4), None), (2, 1), 33.3, ""), {})


async def joined(client: Any, address: str, token: str | None = None) -> Any:
    parts = urlsplit(address)
    query = {"token": parse_qs(parts.query)["token"][0] if token is None else token}
    origin = f"http://{parts.netloc}"
    return await client.ws_connect(f"{origin}/game", params=query, headers={"Origin": origin})


async def heard(line: Any, kind: str) -> dict[str, Any]:
    while True:
        message = json.loads((await line.receive(timeout=20.0)).data)
        if message["kind"] == kind:
            return message


async def until_closed(line: Any) -> None:
    while not line.closed:
        await line.receive(timeout=20.0)


def test_who_knows_the_token_sees_what_is_fed_and_can_change_nothing() -> None:
    async def run() -> None:
        with closing(Feed(0)) as feed:
            assert urlsplit(feed.address).hostname == "127.0.0.1"
            feed.put(WELCOME)
            feed.put(state(1.0))
            async with aiohttp.ClientSession() as client:
                parts = urlsplit(feed.address)
                assert (await client.get(f"http://{parts.netloc}/")).status == 403
                assert (await client.get(feed.address)).status == 200
                assert (await client.get(feed.address.replace("/?", "/recording?name=x&"))).status == 404
                with pytest.raises(aiohttp.WSServerHandshakeError, match="403"):
                    await joined(client, feed.address, "another")
                line = await joined(client, feed.address)
                welcome = await heard(line, "welcome")
                assert welcome["names"] == ["one", "two"] and welcome["seat"] is None
                first = await heard(line, "state")
                assert first["puck"] == [0.25, 0.5] and first["mallets"] == [[0.3, 0.4], None]
                assert first["score"] == [2, 1] and first["left"] == 33.3
                for said in ('{"kind":"aim","x":0.5,"y":0.5,"sent":1}', '{"kind":"again"}', '{"kind":"ping","sent":9}'):
                    await line.send_str(said)
                assert (await heard(line, "pong"))["sent"] == 9
                feed.put(state(2.0))
                assert (await heard(line, "state"))["time"] == 2.0
                bad = await joined(client, feed.address)
                await bad.send_str("nonsense")
                await until_closed(bad)
                feed.put(state(3.0))
                assert (await heard(line, "state"))["time"] == 3.0
                last = asyncio.create_task(until_closed(line))
                await asyncio.to_thread(feed.close)
                await last
                assert line.close_code == GONE  # with which a page does not come back

    asyncio.run(run())


def test_a_server_that_stands_still_holds_nobody_up() -> None:
    """What the pipe does not take is dropped, and the server that goes on shows the newest of what it has."""
    feed = Feed(0)
    try:
        stopped = feed._process
        stopped.send_signal(19)  # SIGSTOP
        for number in range(5000):  # over a megabyte, of which a pipe takes a part
            feed.put(state(number))
        stopped.kill()
        stopped.wait()
        feed.put(state(0.0))  # to nobody
    finally:
        feed.close()


def test_a_port_that_is_taken_is_refused_in_one_line() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(ValueError, match=f"^cannot listen on 127.0.0.1:{port}: .*; give another --port$"):
            Feed(port)


def test_the_server_ends_with_the_process_that_feeds_it() -> None:
    code = "import os\nfrom sim2real.arena.watching.feed import Feed\nprint(Feed(0).address, flush=True)\nos._exit(1)"
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        port = urlsplit(process.stdout.readline().strip()).port
    assert port is not None
    for _ in range(200):
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)):
                return
        time.sleep(0.05)
    pytest.fail("it still listens")
