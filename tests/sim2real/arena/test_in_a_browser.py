"""The arena in headless Chromium: one joins, moves, is remembered after a lost connection, and watches."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from tests.sim2real.arena.running import arena

playwright = pytest.importorskip("playwright.sync_api", reason="it comes with pip install '.[test]'")
BROWSER = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")

pytestmark = [pytest.mark.slow, pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")]


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with playwright.sync_playwright() as started:
        found = started.chromium.launch(executable_path=BROWSER, args=["--no-sandbox"])
        yield found
        found.close()


def opened(page: Any, address: str) -> Any:
    """The page with the arena, whose first states have come; whatever it complains about fails the test."""
    page.on("pageerror", lambda error: pytest.fail(str(error)))
    page.goto(address)
    until(page, lambda: shown(page) > 0.1)
    return page


def until(page: Any, holds: Callable[[], bool]) -> None:
    """Wait until something holds; the page's policy forbids the browser's own way."""
    for _ in range(200):
        if holds():
            return
        page.wait_for_timeout(50)
    pytest.fail("it did not come to hold in ten seconds")


def shown(page: Any) -> float:
    """The time of play [s] of the newest state that the page has."""
    return float(page.get_attribute("#table", "data-shown") or 0.0)


def mallet_of(page: Any) -> tuple[float, float]:
    """Where the person's mallet is [m], by the newest state that the page has."""
    x, y = page.evaluate("JSON.parse(document.getElementById('table').dataset.mallet)")
    return x, y


def test_one_joins_moves_and_comes_back_into_the_same_game(browser: Any) -> None:
    with arena("goalie") as address:
        page, connections = browser.new_page(viewport={"width": 1000, "height": 640}), []
        page.route_web_socket("**/game**", lambda side: connections.extend([side, side.connect_to_server()]))
        opened(page, address)
        assert page.inner_text("#name-0") == "you" and page.inner_text("#name-1") == "goalie"
        box = page.locator("#table").bounding_box()
        for share, nearest in ((0.2, 0.3), (0.8, 0.7)):
            page.mouse.move(box["x"] + 0.25 * box["width"], box["y"] + share * box["height"])
            page.wait_for_timeout(700)
            _, y = mallet_of(page)
            assert abs(1.0 - share - y) < 0.1 and (y > 0.5) == (nearest < 0.5)
        before = shown(page)
        for side in connections:
            side.close()
        until(page, lambda: "trying again" in page.inner_text("#note"))
        until(page, lambda: shown(page) > before + 0.5)
        page.reload()
        until(page, lambda: shown(page) > 0.1)
        assert before + 0.5 < shown(page) < before + 10.0  # the same game, not a new one


def test_the_arrow_keys_move_the_mallet(browser: Any) -> None:
    with arena("still") as address:
        page = opened(browser.new_page(), address)
        page.wait_for_timeout(500)
        before = mallet_of(page)
        page.keyboard.down("ArrowUp")
        page.wait_for_timeout(300)
        page.keyboard.up("ArrowUp")
        page.wait_for_timeout(300)
        x, y = mallet_of(page)
        assert y > before[1] + 0.1 and abs(x - before[0]) < 0.05


def test_two_players_are_watched_on_a_narrow_phone(browser: Any) -> None:
    with arena("interceptor", "goalie") as address:
        page = opened(browser.new_page(viewport={"width": 390, "height": 800}), address)
        assert page.inner_text("#note") == "watching"
        box = page.locator("#table").bounding_box()
        assert box["height"] > box["width"] and box["width"] <= 390  # upright
        before = shown(page)
        until(page, lambda: shown(page) > before + 0.5)
