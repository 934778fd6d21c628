"""What the server answers about recordings: what the page draws, the diagnosis, and films."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from pathlib import Path

from aiohttp import web

from puckpilot_env.files import small_file
from sim2real.arena.access import HEADERS, refuse_strangers
from sim2real.arena.concealed import revealed
from sim2real.arena.recordings.diagnoser import Diagnoser
from sim2real.arena.recordings.film_maker import BusyError, FilmMaker, Part
from sim2real.arena.recordings.reader import Reader, UnreadableError
from sim2real.arena.recordings.records import Records

RECORDS = web.AppKey("records", Records)
READER = web.AppKey("reader", Reader)
DIAGNOSER = web.AppKey("diagnoser", Diagnoser)
FILMS = web.AppKey("films", FilmMaker)
DIAGNOSES = "diagnoses"  # in the folder of the recordings
REPORT, MOST_BYTES = "report.html", 1 << 26
INERT = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"  # of a page: nothing in it runs


def add_recordings(app: web.Application, records: Records, diagnoses: Mapping[str, Path]) -> None:
    """Let the server show recordings with their diagnoses, of which some are given by the recording's name."""
    app[RECORDS], app[READER], app[FILMS] = records, Reader(), FilmMaker()
    app[DIAGNOSER] = Diagnoser(records.folder / DIAGNOSES, diagnoses)
    app.router.add_get("/recording", _recording)
    app.router.add_get("/diagnosis", _diagnosis)
    app.router.add_post("/diagnosis", _diagnose)
    app.router.add_get("/diagnosed", _diagnosed)
    app.router.add_get("/report", _report)
    app.router.add_get("/film", _film)
    app.on_shutdown.append(_close)


async def _recording(request: web.Request) -> web.Response:
    """A recording by its name."""
    return _json(await _read(request, _asked(request)[1]))


async def _diagnosis(request: web.Request) -> web.Response:
    """How far the diagnosis of a recording is; once it is there, what was concealed in the game besides."""
    name, folder = _asked(request)
    state: dict[str, object] = {**request.app[DIAGNOSER].state(name, folder)}
    if state["state"] == "there":
        state["concealed"] = revealed(request.app[RECORDS].folder, name)
    return web.json_response(state, headers=HEADERS)


async def _diagnose(request: web.Request) -> web.Response:
    """Diagnose a recording, unless that is done or goes on."""
    request.app[DIAGNOSER].begin(*_asked(request))
    return await _diagnosis(request)


async def _diagnosed(request: web.Request) -> web.Response:
    """What was found in a recording, and what that makes of the predictions."""
    _, folder = _asked(request)
    return _json(await _read(request, folder, _found(request)))


async def _report(request: web.Request) -> web.Response:
    """The report of a diagnosis, a page without scripts."""
    try:
        text = await asyncio.to_thread(small_file.read_text, _found(request) / REPORT, MOST_BYTES)
    except (OSError, ValueError) as error:
        raise web.HTTPNotFound(text=f"the report cannot be read: {error}") from None
    return web.Response(text=text, content_type="text/html", headers=HEADERS | {"Content-Security-Policy": INERT})


def _found(request: web.Request) -> Path:
    """The folder of the diagnosis of the recording that is asked for."""
    name, folder = _asked(request)
    diagnosis = request.app[DIAGNOSER].find(name, folder)
    if diagnosis is None:
        raise web.HTTPNotFound(text=f"there is no diagnosis of {name[:80]!r} yet")
    return diagnosis


async def _film(request: web.Request) -> web.Response:
    """A film of a recording, from and to so many seconds of it; what is wrong with that is said in a line."""
    _, folder = _asked(request)
    try:
        part = Part.parse(request.query.get("from", ""), request.query.get("to", ""))
        film = await request.app[FILMS].make(await _read(request, folder), part)
    except ValueError as error:
        raise web.HTTPBadRequest(text=str(error)) from None
    except BusyError:
        raise web.HTTPServiceUnavailable(text="other films are being made; ask again in a moment") from None
    except UnreadableError as error:
        raise web.HTTPUnprocessableEntity(text=str(error)) from None
    return web.Response(body=film, content_type="video/mp4", headers=HEADERS)


def _asked(request: web.Request) -> tuple[str, Path]:
    """The recording that is asked for, its name and its folder."""
    refuse_strangers(request)
    name = request.query.get("name", "")
    folder = request.app[RECORDS].find(name)
    if folder is None:
        raise web.HTTPNotFound(text=f"there is no recording {name[:80]!r} here")
    return name, folder


async def _read(request: web.Request, *folders: Path) -> str:
    """What the page draws of a recording, and of its diagnosis; what is wrong with it is said in a line."""
    try:
        return await request.app[READER].read(*folders)
    except UnreadableError as error:
        raise web.HTTPUnprocessableEntity(text=str(error)) from None


def _json(text: str) -> web.Response:
    response = web.Response(text=text, content_type="application/json", headers=HEADERS)
    response.enable_compression()
    return response


async def _close(app: web.Application) -> None:
    await app[DIAGNOSER].close()
