"""In headless Chromium: a game of the twin is watched, a tournament goes on by itself, and a film plays."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.places import ROOT
from tests.sim2real.arena.running import arena
from tests.sim2real.arena.test_in_a_browser import BROWSER, browser, chromium, replayed, shown, until  # noqa: F401

playwright = pytest.importorskip("playwright.sync_api", reason="it comes with pip install '.[test]'")
pytestmark = [pytest.mark.slow, pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")]

# An arena whose matches last some seconds of play, and with a short pause between them
SHORT = """
import sys, puckpilot
from sim2real.arena import game
from sim2real.arena.tournament import tour
tour.PAUSE = 1.0
def short(self, names, seed, made=game.Game.__init__, **choices):
    made(self, names, seed, **choices)
    self.tables.states["steps"] = 180 * 120 - 120
game.Game.__init__ = short
sys.exit(puckpilot.main(sys.argv[1:]))
"""


def test_a_game_of_the_twin_is_watched(browser: Any) -> None:  # noqa: F811
    pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")
    words = ["play", "interceptor", "--opponent", "goalie", "--arena", "--port", "0"]
    command = [sys.executable, "-m", "puckpilot", *words]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            page = browser.new_page()
            page.on("pageerror", lambda error: pytest.fail(str(error)))
            page.goto(process.stdout.readline().split()[-1])
            until(page, lambda: shown(page) > 0.1, 300.0)  # the emulated board may be compiled first
            assert [page.inner_text(f"#name-{k}") for k in (0, 1)] == ["interceptor", "goalie"]
            assert page.inner_text("#note") == "watching" and page.inner_text("#clock") in ("3:00", "2:59", "2:58")
            before, place = shown(page), page.get_attribute("#table", "data-mallet")
            until(page, lambda: shown(page) > before + 1.0 and page.get_attribute("#table", "data-mallet") != place)
            process.send_signal(signal.SIGINT)
            until(page, lambda: page.inner_text("#note") == "the game is over", 180.0)  # once the mallet is home
            assert process.wait(60.0) == 0
        finally:
            process.kill()


def test_a_tournament_goes_on_to_the_next_match(browser: Any, tmp_path: Path) -> None:  # noqa: F811
    words = ["arena", "still", "goalie", "follower", "--port", "0", "--out", str(tmp_path)]
    with subprocess.Popen([sys.executable, "-c", SHORT, *words], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            page = browser.new_page(viewport={"width": 390, "height": 800})
            page.on("pageerror", lambda error: pytest.fail(str(error)))
            page.goto(process.stdout.readline().split()[0])
            until(page, lambda: page.inner_text("#name-0") == "still")
            until(page, lambda: page.is_visible("#standings"))
            until(page, lambda: "next: goalie against still" in page.inner_text("#standings"))
            until(page, lambda: page.inner_text("#name-0") == "goalie" and not page.is_visible("#standings"))
            assert page.evaluate("document.documentElement.scrollWidth") <= 390
            page.click("#ratings")
            assert page.is_visible("#standings") and page.locator("#standings tbody tr").count() == 3
            assert "now: goalie against still" in page.inner_text("#standings")
            assert page.eval_on_selector("#standings", "(part) => part.scrollWidth <= part.clientWidth")
        finally:
            process.kill()
    games = [json.loads(line)["players"] for line in (tmp_path / "games.jsonl").read_text().splitlines()]
    assert games[0] == ["still", "goalie"]


def test_a_film_of_a_recording_plays(browser: Any, tmp_path: Path) -> None:  # noqa: F811
    with arena(str(ROOT / "sim2real" / "demo_recording"), "--out", str(tmp_path)) as address:
        page = replayed(browser.new_page(viewport={"width": 900, "height": 700}), address, 14.0)
        page.click("#film summary")
        until(page, lambda: [page.input_value(f"#{name}") for name in ("from", "to")] == ["9.0", "19.0"])
        page.fill("#from", "13")
        page.fill("#to", "13.5")
        with page.expect_download(timeout=180_000) as saved:
            page.click("#film button")
        saved.value.save_as(tmp_path / "film.mp4")
        other = browser.new_page()
        other.goto((tmp_path / "film.mp4").as_uri())  # the browser shows a video of its own
        video = "document.querySelector('video')"
        until(other, lambda: other.evaluate(f"{video}.readyState >= 2 && {video}.videoWidth > 100"), 60.0)
        assert other.evaluate(f"{video}.duration") == pytest.approx(16 / 30, abs=0.05)
        other.evaluate(f"{video}.play()")
        until(other, lambda: other.evaluate(f"{video}.ended || {video}.currentTime > 0.1"))
