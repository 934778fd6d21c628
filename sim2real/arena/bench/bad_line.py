"""A line that delays and loses, between a page and the arena's server.

It loses as TCP shows it: what is lost is sent again later, and all behind it waits for that.
"""

from __future__ import annotations

import asyncio
import random
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress

CHUNK = 1400  # bytes, of which one packet has no more
RESENT = 0.2  # s after a round trip, until what was lost is sent again: the least of Linux
MOST_WAITING = 1000  # packets


@asynccontextmanager
async def bad_line(port: int, delay: float, loss: float, seed: int) -> AsyncIterator[int]:
    """A port of this machine, behind which is `port` at the end of a line that takes `delay` [s] each way and loses a
    share `loss` of packets."""
    draws, ways = random.Random(seed), set[asyncio.Task[None]]()

    async def connected(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        there, back = await asyncio.open_connection("127.0.0.1", port)
        for way in (_carry(reader, back, delay, loss, draws), _carry(there, writer, delay, loss, draws)):
            ways.add(task := asyncio.create_task(way))
            task.add_done_callback(ways.discard)

    server = await asyncio.start_server(connected, "127.0.0.1", 0)
    try:
        yield server.sockets[0].getsockname()[1]
    finally:
        server.close()
        for task in list(ways):
            task.cancel()
        await asyncio.gather(*ways, return_exceptions=True)


async def _carry(
    reader: asyncio.StreamReader, writer: asyncio.StreamWriter, delay: float, loss: float, draws: random.Random
) -> None:
    """One way of a connection, until either side closes it."""
    waiting: asyncio.Queue[tuple[float, bytes]] = asyncio.Queue(MOST_WAITING)
    sender = asyncio.create_task(_send(waiting, writer))
    clock, due = asyncio.get_running_loop().time, 0.0
    try:
        with suppress(ConnectionError):
            while packet := await reader.read(CHUNK):
                late = delay + (RESENT + 2.0 * delay if draws.random() < loss else 0.0)
                due = max(due, clock() + late)
                await waiting.put((due, packet))
        await waiting.put((due, b""))
        await sender
    finally:
        sender.cancel()
        writer.close()


async def _send(waiting: asyncio.Queue[tuple[float, bytes]], writer: asyncio.StreamWriter) -> None:
    clock = asyncio.get_running_loop().time
    with suppress(ConnectionError):
        while True:
            due, packet = await waiting.get()
            await asyncio.sleep(max(due - clock(), 0.0))
            if not packet:
                return
            writer.write(packet)
            await writer.drain()
