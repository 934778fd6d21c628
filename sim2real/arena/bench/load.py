"""Many pages at once: people who play, and those who look on at their games."""

from __future__ import annotations

import asyncio
import json
import math
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Any
from urllib.parse import parse_qs, urlsplit

import aiohttp

AIM_EVERY = 1.0 / 60.0  # s


@dataclass
class Page:
    """A page without a browser: it counts the `states` that reach it while it is `counting`."""

    socket: aiohttp.ClientWebSocketResponse
    welcome: dict[str, Any]
    states: int = 0
    counting: bool = False

    async def hear(self) -> None:
        """Listen until the line closes, and play again after a match."""
        async for message in self.socket:
            heard = json.loads(message.data)
            if heard["kind"] == "state":
                self.states += self.counting
                if heard["ending"] and self.welcome["seat"] is not None:
                    await self.socket.send_str('{"kind":"again"}')

    async def aim(self) -> None:
        """Move the pointer on a circle."""
        while not self.socket.closed:
            now = time.monotonic()
            x, y = 0.5 + 0.2 * math.cos(2.0 * now), 0.5 + 0.3 * math.sin(2.0 * now)
            await self.socket.send_str(json.dumps({"kind": "aim", "x": x, "y": y, "sent": 1e3 * now}))
            await asyncio.sleep(AIM_EVERY)


async def rates(address: str, games: int, watchers: int, seconds: float) -> tuple[list[float], float]:
    """States a second that reach each page: the players of `games`, then `watchers`, which are spread over them; and
    what the server takes of a core. ConnectionError if it lets a page go."""
    async with aiohttp.ClientSession() as client:
        pages = [await join(client, address) for _ in range(games)]
        for k in range(watchers):
            pages.append(await join(client, address, pages[k % games].welcome["watch"]))
        async with going_on([page.hear() for page in pages] + [page.aim() for page in pages[:games]]):
            await asyncio.sleep(1.0)
            begin, before = time.monotonic(), await health(address)
            for page in pages:
                page.counting = True
            await asyncio.sleep(seconds)
            passed, after = time.monotonic() - begin, await health(address)
            if any(page.socket.closed for page in pages):
                raise ConnectionError("the server let a page go")
        return [page.states / passed for page in pages], (after["processor_s"] - before["processor_s"]) / passed


async def health(address: str) -> dict[str, Any]:
    """What the server says of itself."""
    async with aiohttp.ClientSession() as client, client.get(address.replace("?", "health?")) as answer:
        return await answer.json()


async def join(client: aiohttp.ClientSession, address: str, watch: str = "") -> Page:
    """A page that plays, or looks on at a game."""
    parts = urlsplit(address)
    query = {"token": parse_qs(parts.query)["token"][0], "watch": watch}
    origin = f"{parts.scheme}://{parts.netloc}"
    socket = await client.ws_connect(f"{origin}/game", params=query, headers={"Origin": origin})
    welcome = json.loads((await socket.receive()).data)
    return Page(socket, welcome)


@asynccontextmanager
async def going_on(works: list[Any]) -> AsyncIterator[None]:
    """Inside, all of this goes on."""
    tasks = [asyncio.create_task(work) for work in works]
    try:
        yield
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
