"""The arena's server: pages for those who know the token, a WebSocket for each of a game, and recordings."""

from __future__ import annotations

import asyncio
import hmac
import signal
from collections.abc import Awaitable, Callable
from pathlib import Path

from aiohttp import WSCloseCode, web

from sim2real.arena.lobby import FullError, Lobby
from sim2real.arena.messages import MOST_CHARACTERS
from sim2real.arena.recordings.reader import Reader, UnreadableError
from sim2real.arena.recordings.records import Records

PAGE = Path(__file__).with_name("page")
TYPES = {".html": "text/html", ".css": "text/css", ".js": "text/javascript"}
HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-cache",
}
HEARTBEAT, CLOSING = 10.0, 0.2  # s: between two signs of life, and that a page has to say goodbye
ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
PAGES = {"/": "index.html", "/replay": "replay.html"}  # by address
LOBBY = web.AppKey("lobby", Lobby)
TOKEN = web.AppKey("token", str)
RECORDS = web.AppKey("records", Records)
READER = web.AppKey("reader", Reader)


def make_app(lobby: Lobby, records: Records, token: str) -> web.Application:
    """The application that serves the pages, their WebSockets, and recordings."""
    app = web.Application(client_max_size=1024)
    app[LOBBY], app[RECORDS], app[TOKEN] = lobby, records, token
    app[READER] = Reader()
    for address, page in PAGES.items():
        app.router.add_get(address, _page(page))
    app.router.add_get("/game", _game)
    app.router.add_get("/recording", _recording)
    for file in sorted(PAGE.iterdir()):
        if file.suffix in TYPES and file.name not in PAGES.values():
            app.router.add_get(f"/{file.name}", _file)
    app.on_shutdown.append(_close)
    return app


async def serve(app: web.Application, host: str, port: int, say: Callable[[int], None]) -> int:
    """Serve until a signal asks for the end; its number. `say` is called with the port once pages can come. OSError
    where it cannot listen."""
    runner = web.AppRunner(app, handle_signals=False, access_log=None, shutdown_timeout=1.0)
    await runner.setup()
    try:
        await web.TCPSite(runner, host, port).start()
        say(runner.addresses[0][1])
        return await _signal()
    finally:
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
        _refuse_strangers(request)
        return _response(PAGE / name)

    return page


async def _file(request: web.Request) -> web.Response:
    return _response(PAGE / request.path[1:])


async def _recording(request: web.Request) -> web.Response:
    """A recording by its name; what is wrong with it is said in a line."""
    _refuse_strangers(request)
    name = request.query.get("name", "")
    folder = request.app[RECORDS].find(name)
    if folder is None:
        raise web.HTTPNotFound(text=f"there is no recording {name[:80]!r} here")
    try:
        text = await request.app[READER].read(folder)
    except UnreadableError as error:
        raise web.HTTPUnprocessableEntity(text=str(error)) from None
    response = web.Response(text=text, content_type="application/json", headers=HEADERS)
    response.enable_compression()
    return response


async def _game(request: web.Request) -> web.StreamResponse:
    _refuse_strangers(request)
    if request.headers.get("Origin") != f"{request.scheme}://{request.host}":
        raise web.HTTPForbidden(text="a page of another origin")
    # without autoping every message counts, and no flood of them keeps the loop from the games
    socket = web.WebSocketResponse(
        timeout=CLOSING, heartbeat=HEARTBEAT, max_msg_size=4 * MOST_CHARACTERS, compress=False, autoping=False
    )
    await socket.prepare(request)
    transport = request.transport
    assert isinstance(transport, asyncio.Transport)
    try:
        await request.app[LOBBY].join(socket, transport, request.query.get("id", ""))
    except FullError:
        await socket.close(code=WSCloseCode.TRY_AGAIN_LATER, message=b"the arena is full")
    return socket


def _refuse_strangers(request: web.Request) -> None:
    if not hmac.compare_digest(request.query.get("token", "").encode(), request.app[TOKEN].encode()):
        raise web.HTTPForbidden(text="the address needs the token that puckpilot arena printed")


def _response(file: Path) -> web.Response:
    return web.Response(body=file.read_bytes(), content_type=TYPES[file.suffix], charset="utf-8", headers=HEADERS)


async def _close(app: web.Application) -> None:
    app[LOBBY].close()
