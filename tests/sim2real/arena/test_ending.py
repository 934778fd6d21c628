"""The arena ends when it is asked to, whatever it is at; nobody who looks on keeps it."""

from __future__ import annotations

import asyncio
import signal
from pathlib import Path
from typing import Any, cast

import pytest

pytest.importorskip("aiohttp", reason="it comes with pip install '.[test]'")

from sim2real.arena.listener import Listener
from sim2real.arena.lobby import Lobby
from sim2real.arena.recordings.records import Records
from sim2real.arena.server import make_app, serve


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_in_the_midst_of_a_step_that_lets_nothing_out_ends_it(number: signal.Signals, tmp_path: Path) -> None:
    def step() -> None:
        try:
            signal.raise_signal(number)
            sum(range(100))  # a handler of Python's runs between two of its instructions
        except BaseException:  # as compiled code does, which cannot raise
            pass

    def say(port: int) -> None:
        asyncio.get_running_loop().call_later(0.05, step)

    records = Records(tmp_path)
    kept = signal.signal(number, signal.SIG_DFL)  # a run in the background ignores some, and so does the arena then
    app = make_app(Lobby(("still", "goalie"), 0, records), records, "a-token")
    try:
        assert asyncio.run(asyncio.wait_for(serve(app, "127.0.0.1", 0, say), 30.0)) == number
    finally:
        signal.signal(number, kept)


class Taking:
    """A line that takes every message, each in so many steps of the loop."""

    closed = False

    def __init__(self, steps: int) -> None:
        self._steps = steps

    async def send_str(self, message: str) -> None:
        for _ in range(self._steps):
            await asyncio.sleep(0)


@pytest.mark.parametrize("steps", range(4))
@pytest.mark.parametrize("later", range(8))
def test_a_listener_that_is_let_go_while_it_sends_sends_no_more(steps: int, later: int) -> None:
    async def run() -> None:
        listener = Listener(cast(Any, Taking(steps)), cast(Any, None))
        sender = asyncio.create_task(listener.send())
        for _ in range(later):
            listener.show("a state")
            await asyncio.sleep(0)
        sender.cancel()
        done, _ = await asyncio.wait([sender], timeout=0.5)
        assert done

    asyncio.run(run())
