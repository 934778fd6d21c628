"""The server of a game that is played by another process, which says here line by line what there is to see."""

from __future__ import annotations

import asyncio
import os
import secrets
import sys

from sim2real.arena.server import make_app, serve
from sim2real.arena.watching.broadcast import Broadcast

HOST = "127.0.0.1"
SOME = 65536  # bytes that are read at once


async def relay(port: int) -> int:
    """Serve what comes by the standard input until that ends; 0. OSError where it cannot listen."""
    token, broadcast = secrets.token_urlsafe(12), Broadcast()

    async def wait() -> int:
        reader = asyncio.StreamReader()
        transport, _ = await asyncio.get_running_loop().connect_read_pipe(
            lambda: asyncio.StreamReaderProtocol(reader), sys.stdin
        )
        try:
            await _pass_on(reader, broadcast)
        finally:
            transport.close()
        await broadcast.end()
        return 0

    def say(found: int) -> None:
        print(f"http://{HOST}:{found}/?token={token}", flush=True)

    return await serve(make_app(broadcast, None, token), HOST, port, say, wait)


async def _pass_on(reader: asyncio.StreamReader, broadcast: Broadcast) -> None:
    """All lines, but of several states that came at once the newest alone."""
    rest = b""
    while some := await reader.read(SOME):
        *lines, rest = (rest + some).split(b"\n")
        newest = ""
        for line in lines:
            message = line.decode()
            if message.startswith('{"kind":"state"'):
                newest = message
            else:
                newest = ""
                broadcast.welcome(message)
        if newest:
            broadcast.show(newest)


def main() -> int:
    """Serve at the port that is named. 2: it cannot listen there, and one line says why."""
    if hasattr(os, "SCHED_BATCH"):  # so that a view that comes does not take the processor from who sent it
        os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    port = int(sys.argv[1])
    try:
        return asyncio.run(relay(port))
    except OSError as error:
        why = os.strerror(error.errno) if error.errno else str(error)
        print(f"cannot listen on {HOST}:{port}: {why}; give another --port", flush=True)
        return 2


if __name__ == "__main__":
    raise SystemExit(main())
