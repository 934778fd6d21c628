"""The arena in headless Chromium: one joins, moves, comes back after a lost connection, watches, and sees a replay."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.places import ROOT
from tests.sim2real.arena.recordings.made_diagnosis import LINES, write_diagnosis
from tests.sim2real.arena.running import arena

playwright = pytest.importorskip("playwright.sync_api", reason="it comes with pip install '.[test]'")
BROWSER = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")

# Whether the middle of the table, which is a line across it, has a colour
PAINTED = "table.getContext('2d').getImageData(table.width / 2, table.height / 2, 1, 1).data[3] > 0"

pytestmark = [pytest.mark.slow, pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")]


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    with playwright.sync_playwright() as started:
        found = started.chromium.launch(executable_path=BROWSER, args=["--no-sandbox"])
        yield found
        found.close()


@pytest.fixture
def browser(chromium: Any) -> Iterator[Any]:
    """The browser, whose pages are closed after each test: one that stays draws on."""
    yield chromium
    for context in chromium.contexts:
        context.close()


def opened(page: Any, address: str) -> Any:
    """The page with the arena, whose first states have come; whatever it complains about fails the test."""
    page.on("pageerror", lambda error: pytest.fail(str(error)))
    page.goto(address)
    until(page, lambda: shown(page) > 0.1)
    return page


def until(page: Any, holds: Callable[[], bool], seconds: float = 30.0) -> None:
    """Wait until something holds; the page's policy forbids the browser's own way."""
    for _ in range(round(20 * seconds)):
        if holds():
            return
        page.wait_for_timeout(50)
    pytest.fail(f"it did not come to hold in {seconds:g} s")


def replayed(page: Any, address: str, time: float) -> Any:
    """The page of a recording at a time of it [s]."""
    page.on("pageerror", lambda error: pytest.fail(str(error)))
    page.goto(f"{address}&at={time}")
    until(page, lambda: page.get_attribute("#table", "data-shown") is not None, 60.0)
    return page


def shown(page: Any) -> float:
    """The time of play [s] of the newest state that the page has."""
    return float(page.get_attribute("#table", "data-shown") or 0.0)


def mallet_of(page: Any) -> tuple[float, float]:
    """Where the person's mallet is [m], by the newest state that the page has."""
    x, y = page.evaluate("JSON.parse(document.getElementById('table').dataset.mallet)")
    return x, y


def puck_of(page: Any) -> tuple[float, float]:
    """Where the puck is [m], by the newest state that the page has."""
    x, y = page.evaluate("JSON.parse(document.getElementById('table').dataset.puck)")
    return x, y


def test_one_joins_moves_and_comes_back_into_the_same_game(browser: Any) -> None:
    with arena("goalie") as address:
        page, connections = browser.new_page(viewport={"width": 1000, "height": 640}), []
        page.route_web_socket("**/game**", lambda side: connections.extend([side, side.connect_to_server()]))
        opened(page, address)
        assert page.inner_text("#name-0") == "you (guest)" and page.inner_text("#name-1") == "goalie"
        box = page.locator("#table").bounding_box()
        for share in (0.2, 0.8):
            page.mouse.move(box["x"] + 0.25 * box["width"], box["y"] + share * box["height"])
            until(page, lambda share=share: abs(1.0 - share - mallet_of(page)[1]) < 0.1)
        before = shown(page)
        for side in connections:
            side.close()
        until(page, lambda: "trying again" in page.inner_text("#note"))
        until(page, lambda: shown(page) > before + 0.5)
        page.reload()
        until(page, lambda: shown(page) > 0.1)
        assert shown(page) > before + 0.5  # the same game, not a new one


def test_the_mallet_is_drawn_where_a_finger_points_from_the_other_end_of_a_phone(browser: Any) -> None:
    with arena("still", "--seat", "1") as address:
        page = opened(browser.new_page(viewport={"width": 390, "height": 800}), address)
        box = page.locator("#table").bounding_box()
        metre = box["height"] / 2.14  # the table and its margins
        x, y = 1.6, 0.7  # far from the one who holds the phone, for player 1 is drawn above
        page.mouse.move(box["x"] + (1.07 - y) * metre, box["y"] + (2.07 - x) * metre)
        until(
            page, lambda: json.loads(page.get_attribute("#table", "data-drawn"))[1:] == pytest.approx([x, y], abs=5e-3)
        )
        until(page, lambda: mallet_of(page) == pytest.approx((x, y), abs=5e-3))
        page.reload()
        until(page, lambda: shown(page) > 0.1)
        page.mouse.move(box["x"] + (1.07 - y) * metre, box["y"] + (2.07 - 1.3) * metre)
        until(page, lambda: json.loads(page.get_attribute("#table", "data-drawn"))[1] == pytest.approx(1.3, abs=5e-3))


def test_a_person_hits_the_puck(browser: Any) -> None:
    """With this seed the puck comes to the person's side and lies down there; nobody else moves it."""
    with arena("still", "--seed", "7") as address:
        page = opened(browser.new_page(viewport={"width": 1000, "height": 640}), address)
        box = page.locator("#table").bounding_box()
        until(page, lambda: shown(page) > 3.0)
        x, y = puck_of(page)
        assert x < 0.9
        metre = box["width"] / 2.14  # the table and its margins
        page.mouse.move(box["x"] + (0.07 + x) * metre, box["y"] + (1.07 - y) * metre)
        until(page, lambda: puck_of(page)[0] > x + 0.5)  # farther than it could roll by itself
        assert page.inner_text("#score") in ("0 : 0", "1 : 0")


def test_a_friend_looks_on_by_the_link(browser: Any) -> None:
    with arena("still", "--name", "ann") as address:
        page = opened(browser.new_page(), address)
        friend = opened(browser.new_page(), page.evaluate("document.getElementById('watch').href"))
        assert friend.inner_text("#note") == "watching" and friend.is_hidden("#watch") and page.is_visible("#watch")
        before = shown(page)
        friend.keyboard.press("ArrowUp")
        until(friend, lambda: shown(friend) > before + 0.3)
        assert page.inner_text("#name-0") == "you (ann)" and friend.inner_text("#name-0") == "ann"
        assert page.inner_text("#note") == "point, or press an arrow key"
        page.keyboard.down("ArrowUp")
        until(page, lambda: page.inner_text("#note") == "")


def test_the_arrow_keys_move_the_mallet(browser: Any) -> None:
    with arena("still") as address:
        page = opened(browser.new_page(), address)
        page.wait_for_timeout(500)
        before = mallet_of(page)
        page.keyboard.down("ArrowUp")
        until(page, lambda: mallet_of(page)[1] > before[1] + 0.1)
        page.keyboard.up("ArrowUp")
        assert abs(mallet_of(page)[0] - before[0]) < 0.05
        page.wait_for_timeout(500)
        across = mallet_of(page)[0]
        page.keyboard.press("ArrowLeft")  # down and up between two pictures
        until(page, lambda: mallet_of(page)[0] < across - 0.005)


def test_two_players_are_watched_on_a_narrow_phone(browser: Any) -> None:
    with arena("interceptor", "goalie") as address:
        page = opened(browser.new_page(viewport={"width": 390, "height": 800}), address)
        assert page.inner_text("#note") == "watching"
        box = page.locator("#table").bounding_box()
        assert box["height"] > box["width"] and box["width"] <= 390  # upright
        before = shown(page)
        until(page, lambda: shown(page) > before + 0.5)


def test_a_goal_is_counted_and_the_replay_equals_the_game(browser: Any, tmp_path: Path) -> None:
    seen = []
    with arena("veteran", "still", "--out", str(tmp_path)) as address:
        page = opened(browser.new_page(), address)
        for _ in range(600):
            seen.append(page.evaluate("(({ shown, mallet }) => [+shown, JSON.parse(mallet)])(table.dataset)"))
            if page.inner_text("#score") == "1 : 0":
                break
            page.wait_for_timeout(100)
        assert page.inner_text("#score") == "1 : 0"
        page.close()
    (recording,) = tmp_path.glob("[!.]*/meta.json")
    with arena(str(recording.parent), "--out", str(tmp_path)) as address:
        page = browser.new_page(viewport={"width": 1000, "height": 700})
        for time, mallet in seen[:: -(len(seen) // 3)]:  # the earliest last, from where it can go on
            again = json.loads(replayed(page, address, time).get_attribute("#table", "data-mallet"))
            assert again == pytest.approx(mallet, abs=1e-3)
        page.keyboard.press("ArrowRight")
        until(page, lambda: abs(shown(page) - time - 1 / 120) < 1e-3)
        page.click("#play")
        until(page, lambda: shown(page) > time + 0.3)


def test_a_recording_is_shown_beside_the_simulator(browser: Any) -> None:
    with arena(str(ROOT / "sim2real" / "demo_recording")) as address:
        page = replayed(browser.new_page(viewport={"width": 390, "height": 800}), address, 14.0)
        assert "mm from the prediction" in page.inner_text("#what")
        assert page.evaluate("document.documentElement.scrollWidth") <= 390
        page.set_viewport_size({"width": 900, "height": 700})  # which empties what was drawn
        until(page, lambda: page.evaluate(PAINTED))
        puck, expected = (json.loads(page.get_attribute("#table", f"data-{name}")) for name in ("puck", "expected"))
        assert 0.005 < abs(puck[0] - expected[0]) + abs(puck[1] - expected[1]) < 0.05  # the demo's table is tilted
        page.goto(f"{address}&at=soon")
        until(page, lambda: page.inner_text("#clock").startswith("0.00 of"), 60.0)
        page.goto(address.replace("demo_recording", "another"))
        until(page, lambda: "there is no recording 'another' here" in page.inner_text("#note"))
        assert not page.is_visible("#play") and not page.is_visible("#chart")


def test_what_a_diagnosis_found_is_shown_and_its_prediction_is_nearer(browser: Any, tmp_path: Path) -> None:
    """The button finds a diagnosis that was made before, of the demo's own tilt; a narrow page has room for it."""
    demo = Path(shutil.copytree(ROOT / "sim2real" / "demo_recording", tmp_path / "demo"))
    tilt = {"table_tilt": {"tilt_x": 0.02, "tilt_y": -0.012}}
    with arena(str(demo), "--out", str(tmp_path)) as address:
        page = replayed(browser.new_page(viewport={"width": 390, "height": 800}), address, 14.0)
        until(page, lambda: page.is_visible("#diagnose"))
        assert not page.is_visible("#findings") and not page.is_visible("#law")
        before = distance(page)
        write_diagnosis(tmp_path / "diagnoses" / "demo", tilt)
        page.click("#diagnose")
        until(page, lambda: page.is_visible("#law"), 120.0)
        assert page.inner_text("#found") == "\n".join(LINES) and not page.is_visible("#diagnose")
        until(page, lambda: distance(page) < 0.3 * before)
        assert page.input_value("#law") == "after"
        page.select_option("#law", "before")
        until(page, lambda: distance(page) == before)
        report = browser.new_page()
        report.goto(page.evaluate("document.getElementById('report').href"))
        assert report.inner_text("body").strip() == "what was found"
        assert page.evaluate("document.documentElement.scrollWidth") <= 390


def distance(page: Any) -> float:
    """How far the puck is from where it is expected [m], along both axes together."""
    puck, expected = (json.loads(page.get_attribute("#table", f"data-{name}")) for name in ("puck", "expected"))
    return abs(puck[0] - expected[0]) + abs(puck[1] - expected[1])
