"""The arena's server: pages for those who know the token, a WebSocket for each of a game, and recordings."""

from __future__ import annotations

import asyncio
import signal
from collections.abc import Awaitable, Callable, Mapping
from pathlib import Path
from typing import Protocol

from aiohttp import web

from sim2real.arena.access import HEADERS, TOKEN, refuse_strangers
from sim2real.arena.door import DAWDLING, LINGERING, Door
from sim2real.arena.health import health_of
from sim2real.arena.lobby import Lobby, RefusedError
from sim2real.arena.messages import MOST_CHARACTERS
from sim2real.arena.recordings.records import Records
from sim2real.arena.recordings.routes import add_recordings

PAGE = Path(__file__).with_name("page")
TYPES = {".html": "text/html", ".css": "text/css", ".js": "text/javascript"}
HEARTBEAT, CLOSING = 10.0, 0.2  # s: between two signs of life, and that a page has to say goodbye
ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
PAGES = {"/": "index.html", "/replay": "replay.html"}  # by address


class Host(Protocol):
    """Who lets pages into a game: a `Lobby`, or a `Broadcast`."""

    async def join(self, socket: web.WebSocketResponse, transport: asyncio.Transport, known: str, watch: str) -> None:
        """Let a page into its game, which it may know by an id, or into one that it watches, until it is gone.
        RefusedError if that cannot be."""
        ...

    async def close(self) -> None:
        """End all games."""
        ...


HOST = web.AppKey[Host]("host")
DOOR = web.AppKey("door", Door)


def make_app(
    host: Host, records: Records | None, token: str, diagnoses: Mapping[str, Path] | None = None
) -> web.Application:
    """The application that serves the pages, their WebSockets, and recordings, if there are any, with their diagnoses,
    of which some are given by the recording's name."""
    app = web.Application(client_max_size=1024)
    app[HOST], app[TOKEN], app[DOOR] = host, token, Door()
    for address, page in PAGES.items():
        app.router.add_get(address, _page(page))
    app.router.add_get("/game", _game)
    if records is not None:
        add_recordings(app, records, diagnoses or {})
    if isinstance(host, Lobby):
        app.router.add_get("/health", _health(host))
    for file in sorted(PAGE.iterdir()):
        if file.suffix in TYPES and file.name not in PAGES.values():
            app.router.add_get(f"/{file.name}", _file)
    app.on_shutdown.append(_close)
    return app


async def serve(
    app: web.Application,
    host: str,
    port: int,
    say: Callable[[int], None],
    wait: Callable[[], Awaitable[int]] | None = None,
) -> int:
    """Serve until a signal asks for the end; its number. Or until `wait` is over; what that returns. `say` is called
    with the port once pages can come. OSError where it cannot listen."""
    runner = web.AppRunner(
        app, handle_signals=False, access_log=None, shutdown_timeout=1.0, keepalive_timeout=DAWDLING,
        lingering_time=LINGERING,
    )  # fmt: skip
    await runner.setup()
    assert runner.server is not None
    listening = None
    try:
        loop = asyncio.get_running_loop()
        listening = await loop.create_server(app[DOOR].opened_to(runner.server), host, port)
        say(listening.sockets[0].getsockname()[1])
        return await (wait or _signal)()
    finally:
        if listening is not None:
            listening.close()
        await runner.cleanup()


async def _signal() -> int:
    """Wait for a signal that asks for the end; its number. It comes between two steps of the loop: raised in the midst
    of one, asyncio and aiohttp may lose it. A second one has its usual effect."""
    loop = asyncio.get_running_loop()
    asked: asyncio.Future[int] = loop.create_future()

    def end(number: int) -> None:
        if not asked.done():
            asked.set_result(number)

    numbers = [number for number in ENDING if signal.getsignal(number) is not signal.SIG_IGN]  # nohup ignores one
    for number in numbers:
        loop.add_signal_handler(number, end, number)
    try:
        return await asked
    finally:
        for number in numbers:
            loop.remove_signal_handler(number)


def _page(name: str) -> Callable[[web.Request], Awaitable[web.Response]]:
    async def page(request: web.Request) -> web.Response:
        refuse_strangers(request)
        return _response(PAGE / name)

    return page


async def _file(request: web.Request) -> web.Response:
    return _response(PAGE / request.path[1:])


async def _game(request: web.Request) -> web.StreamResponse:
    refuse_strangers(request)
    if request.headers.get("Origin") != f"{request.scheme}://{request.host}":
        raise web.HTTPForbidden(text="a page of another origin")
    # without autoping every message counts, and no flood of them keeps the loop from the games
    socket = web.WebSocketResponse(
        timeout=CLOSING, heartbeat=HEARTBEAT, max_msg_size=4 * MOST_CHARACTERS, compress=False, autoping=False
    )
    try:
        await socket.prepare(request)
    except ConnectionError:  # it is gone already; floods of that would fill the terminal
        return web.Response()
    transport, query = request.transport, request.query
    assert isinstance(transport, asyncio.Transport)
    request.app[DOOR].forget(request.protocol)
    try:
        await request.app[HOST].join(socket, transport, query.get("id", ""), query.get("watch", ""))
    except RefusedError as error:
        await socket.close(code=error.code, message=str(error).encode())
    return socket


def _health(lobby: Lobby) -> Callable[[web.Request], Awaitable[web.Response]]:
    async def health(request: web.Request) -> web.Response:
        """How the server keeps up, as JSON."""
        refuse_strangers(request)
        return web.json_response(health_of(lobby), headers=HEADERS)

    return health


def _response(file: Path) -> web.Response:
    return web.Response(body=file.read_bytes(), content_type=TYPES[file.suffix], charset="utf-8", headers=HEADERS)


async def _close(app: web.Application) -> None:
    await app[HOST].close()
