"""A game goes on, and new pages get in, whatever hostile clients send or hold open."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Awaitable, Callable
from typing import Any

import pytest

aiohttp = pytest.importorskip("aiohttp", reason="it comes with pip install '.[test]'")

from sim2real.arena.bench import load  # noqa: E402
from sim2real.arena.door import MOST_STRANGERS  # noqa: E402
from sim2real.arena.lobby import MOST_WATCHERS  # noqa: E402
from tests.sim2real.arena import attack  # noqa: E402
from tests.sim2real.arena.running import arena  # noqa: E402

MESSAGES = 1_000_000
HALF_OPEN = 1000
CLOSING = 5.0  # s that a busy machine takes at most to close what it has let go
MOST_LOST = 2.0  # s of a game's time that a busy machine does not make up for
MOST_MORE = 50 * 2**20  # bytes of memory
Check = Callable[[str, load.Page, Any], Awaitable[None]]

pytestmark = pytest.mark.slow


def while_a_game_goes_on(check: Check) -> None:
    """Run a check beside a game of its own, which it must not disturb."""

    async def run(address: str) -> None:
        async with aiohttp.ClientSession() as client:
            page = await load.join(client, address)
            page.counting = True
            async with load.going_on([page.hear(), page.aim()]):
                before = await load.health(address)
                await check(address, page, client)
                after = await load.health(address)
                states = page.states
                while page.states < states + 60:
                    assert not page.socket.closed
                    await asyncio.sleep(0.05)
        assert after["lost_s"] - before["lost_s"] < MOST_LOST
        if after["most_memory"] is not None:
            assert after["most_memory"] - before["memory"] < MOST_MORE

    with arena("still") as address:
        asyncio.run(asyncio.wait_for(run(address), 100.0))


def test_a_million_messages_are_sent_in_vain() -> None:
    async def check(address: str, page: load.Page, client: Any) -> None:
        def send() -> int:
            sent = 0
            while sent < MESSAGES:
                for name, (said, number) in (attack.SAID | attack.ASKED).items():
                    line = attack.watcher(address, page.welcome["watch"]) if name in attack.SAID else None
                    assert attack.is_closed_after(line or attack.connect(address), said), name
                    sent += number
            return sent

        assert await asyncio.to_thread(send) >= MESSAGES

    while_a_game_goes_on(check)


def test_a_thousand_half_open_connections_keep_nobody_out() -> None:
    async def check(address: str, page: load.Page, client: Any) -> None:
        held = await asyncio.to_thread(attack.half_open, address, page.welcome["watch"], HALF_OPEN)
        assert (await load.join(client, address)).welcome["id"] != page.welcome["id"]
        until = time.monotonic() + CLOSING
        while len(held := [line for line in held if attack.is_open(line)]) > MOST_STRANGERS + MOST_WATCHERS:
            assert time.monotonic() < until
            await asyncio.sleep(0.1)
        assert held
        for line in held:
            line.close()

    while_a_game_goes_on(check)
