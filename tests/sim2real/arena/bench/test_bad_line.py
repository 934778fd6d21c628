"""A line that delays and loses brings all bytes in their order, and each late."""

from __future__ import annotations

import asyncio

import pytest

pytest.importorskip("aiohttp", reason="it comes with pip install '.[test]'")

from sim2real.arena.bench.bad_line import RESENT, bad_line


@pytest.mark.parametrize(("loss", "least"), [(0.0, 0.1), (1.0, 0.1 + 2 * (RESENT + 0.1))])
def test_all_comes_back_in_order_and_no_sooner(loss: float, least: float) -> None:
    async def echo(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        while said := await reader.read(1000):
            writer.write(said)
        writer.close()

    async def run() -> tuple[bytes, float]:
        server = await asyncio.start_server(echo, "127.0.0.1", 0)
        async with bad_line(server.sockets[0].getsockname()[1], 0.05, loss, 1) as port:
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            begin = asyncio.get_running_loop().time()
            for k in range(50):
                writer.write(bytes([k]) * 100)
            first = await reader.readexactly(100)
            passed = asyncio.get_running_loop().time() - begin
            rest = await reader.readexactly(4900)
            writer.close()
        server.close()
        return first + rest, passed

    said, passed = asyncio.run(asyncio.wait_for(run(), 30.0))
    assert said == b"".join(bytes([k]) * 100 for k in range(50)) and passed >= least
