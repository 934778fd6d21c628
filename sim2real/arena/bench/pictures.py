"""From the pointer to the picture: a page in a browser whose pointer is moved, and what its pictures show."""

from __future__ import annotations

import asyncio
import json
import math
import random
import shutil
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim2real.arena.bench.own_motion import Aim, OwnMotion

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
STEP, SHOWS = 0.08, 0.001  # m: that the pointer leaps, and of the mallet's motion that shows it
RESTS = 0.35, 0.55  # s between two leaps
ROUND, RADIUS = 2.5, 0.16  # s and m of the circle that the pointer goes otherwise
CIRCLES = 8.0  # s of it
SETTLES = 1.0  # s after the mallet was placed anew, until it has forgotten that
# Notes when a pointer moved, and each picture once it is painted: when, and the moment [ms] and place [m] of the mallet
NOTES = """
window.moves = []; window.pictures = [];
addEventListener("pointermove", (event) => moves.push(event.timeStamp), true);
const painted = new MessageChannel();
painted.port1.onmessage = () => {
  const drawn = document.getElementById("table")?.dataset.drawn;
  if (drawn) pictures.push([performance.now(), ...JSON.parse(drawn)]);
};
requestAnimationFrame(function look() { requestAnimationFrame(look); painted.port2.postMessage(0); });
"""


class NoBrowserError(Exception):
    """There is nothing to show pages in; the text says in a line what."""


@dataclass
class Seen:
    """What a page did: `moves` [s] of the pointer that leapt; `pictures` (n, 4) of when [s] they were painted, the
    moment that they show [s] and where [m] the mallet was; `aims`; and when [s] it was `placed` anew."""

    moves: list[float] = field(default_factory=list)
    pictures: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 4)))
    aims: list[Aim] = field(default_factory=list)
    placed: list[float] = field(default_factory=list)
    over: float = math.inf  # when [s] the match ended, after which the mallet stands

    def delays(self) -> list[float]:
        """From each leap until a picture showed it [s]."""
        found = []
        for move in self.moves:
            k = int(np.searchsorted(self.pictures[:, 1], move))
            if k == 0 or move > self.over or any(-0.5 < move - at < SETTLES for at in self.placed):
                continue
            gone = np.hypot(*(self.pictures[k:, 2:] - self.pictures[k - 1, 2:]).T) > SHOWS
            if gone.any():
                found.append(float(self.pictures[k + int(gone.argmax()), 0] - move))
        return found

    def beyond(self) -> tuple[float, float]:
        """`(largest jump between two pictures, farthest)` [m] of the mallet beyond its own motion."""
        times = self.pictures[:, 1]
        off = self.pictures[:, 2:] - OwnMotion().places(self.aims, times.tolist())
        calm = (
            (times > self.aims[0][0] + SETTLES)
            & (times < self.over)
            & np.all([~_within(times, at) for at in self.placed or [-99.0]], 0)
        )
        jumps = np.hypot(*np.diff(off, axis=0).T)[calm[1:] & calm[:-1]]
        return float(jumps.max(initial=0.0)), float(np.hypot(*off.T)[calm].max(initial=0.0))


def _within(times: NDArray[np.float64], at: float) -> NDArray[np.bool_]:
    return (times > at - 0.1) & (times < at + SETTLES)


@asynccontextmanager
async def browser() -> AsyncIterator[Any]:
    """A headless Chromium. NoBrowserError, in one line, if there is none."""
    path = next(filter(None, map(shutil.which, BROWSERS)), None)
    if path is None:
        raise NoBrowserError("there is no Chromium")
    try:
        from playwright.async_api import async_playwright
    except ImportError:
        raise NoBrowserError("there is no playwright, which drives Chromium") from None
    async with async_playwright() as started:
        found = await started.chromium.launch(executable_path=path, args=["--no-sandbox"])
        try:
            yield found
        finally:
            await found.close()


async def watched(opened: Any, address: str, leaps: int, seed: int) -> Seen:
    """Play in a page, with circles and leaps of the pointer. TimeoutError if no table comes."""
    seen, draws = Seen(), random.Random(seed)
    page = await opened.new_page(viewport={"width": 1000, "height": 640})
    await page.add_init_script(NOTES)
    page.on("websocket", lambda socket: _listen(socket, seen, page))
    try:
        await page.goto(address)
        async with asyncio.timeout(30.0):
            while not await page.evaluate("window.pictures.length"):
                await asyncio.sleep(0.1)
        box = await page.locator("#table").bounding_box()
        metre = box["width"] / 2.14  # the table and its margins
        middle = box["x"] + 0.57 * metre, box["y"] + 0.5 * box["height"]
        await _circle(page, middle, metre)
        leapt = []
        for _ in range(leaps):
            angle = draws.uniform(0.0, 2.0 * math.pi)
            place = middle[0] + STEP * metre * math.cos(angle), middle[1] + STEP * metre * math.sin(angle)
            before = await page.evaluate("moves.length")
            await page.mouse.move(*place)
            await asyncio.sleep(draws.uniform(*RESTS))
            leapt.append(before)
        noted = await page.evaluate("[moves, pictures]")
        seen.moves = [noted[0][k] / 1e3 for k in leapt if k < len(noted[0])]
        seen.pictures = np.array(noted[1], float) / [1e3, 1e3, 1.0, 1.0]
    finally:
        await page.close()
    return seen


async def _circle(page: Any, middle: tuple[float, float], metre: float) -> None:
    clock = asyncio.get_running_loop().time
    begin = clock()
    while (passed := clock() - begin) < CIRCLES:
        angle = 2.0 * math.pi * passed / ROUND
        x, y = middle[0] + RADIUS * metre * math.cos(angle), middle[1] + RADIUS * metre * math.sin(angle)
        await page.mouse.move(x, y)
        await asyncio.sleep(0.012)


def _listen(socket: Any, seen: Seen, page: Any) -> None:
    """Note the aims that a page sends, when its mallet was placed anew, and when the match ended."""
    known = [0]

    def sent(text: str | bytes) -> None:
        message = json.loads(text)
        if message["kind"] == "aim":
            seen.aims.append((message["sent"] / 1e3, message["x"], message["y"]))

    def received(text: str | bytes) -> None:
        message = json.loads(text)
        if message["kind"] == "state" and message["placed"] != known[0]:
            known[0] = message["placed"]
            seen.placed.append(seen.aims[-1][0] if seen.aims else 0.0)
        if message["kind"] == "state" and message["ending"]:
            seen.over = min(seen.over, seen.aims[-1][0] if seen.aims else 0.0)

    socket.on("framesent", sent)
    socket.on("framereceived", received)
