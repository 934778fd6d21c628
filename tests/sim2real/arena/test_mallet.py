"""The page moves a person's mallet as the simulator does, and corrects it by what the server says."""

from __future__ import annotations

import math
import random
import shutil
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from puckpilot_env.batch.motion import mallet_motion
from sim2real.arena.bench.own_motion import OwnMotion
from sim2real.arena.game import PERSON, TICKS, Game
from sim2real.arena.seats import PersonChair
from tests.sim2real.arena.running import PAGE

playwright = pytest.importorskip("playwright.sync_api", reason="it comes with pip install '.[test]'")
BROWSER = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
pytestmark = [pytest.mark.slow, pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")]

# Plays what is given: [["aim", s, [x, y]], ["take", state, s], ["at", s]]; the places at each "at"
PLAY = """async ({ law, played }) => {
  const { Mallet } = await import("/mallet.js");
  const mallet = new Mallet(law), places = [];
  for (const [what, ...given] of played) {
    const found = mallet[what](...given);
    if (what === "at") places.push(found);
  }
  return places;
}"""


@pytest.fixture(scope="module")
def page() -> Iterator[Any]:
    def answer(route: Any) -> None:
        script = route.request.url.endswith(".js")
        kind = "text/javascript" if script else "text/html"
        route.fulfill(content_type=kind, body=(PAGE / "mallet.js").read_text() if script else "")

    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=BROWSER, args=["--no-sandbox"])
        opened = browser.new_page()
        opened.route("**/*", answer)
        opened.goto("http://arena.test/")
        yield opened
        browser.close()


def seated(seat: int, quick: bool = False) -> tuple[Game, PersonChair]:
    game = Game((PERSON, "still") if seat == 0 else ("still", PERSON), 1, quick=quick)
    assert game.person is not None
    return game, game.person


def place_of(game: Game, seat: int) -> list[float]:
    return mallet_motion(game.tables.states[0])[seat, :2].tolist()


@pytest.mark.parametrize(("seat", "quick"), [(0, False), (1, False), (0, True)])
def test_it_moves_as_the_simulators(page: Any, seat: int, quick: bool) -> None:
    """Aims anywhere, inside and outside of the half, some for a tick and some until the mallet rests."""
    game, person = seated(seat, quick)
    rng, aim, places = random.Random(3), [1.0, 0.5], []
    played: list[list[Any]] = [["take", {**person.followed(), "aim": 0}, 0.0]]
    for tick in range(600):
        if tick % rng.choice([1, 2, 3, 40]) == 0:
            aim = [rng.uniform(0.0, 2.0), rng.uniform(0.0, 1.0)]
        person.aim(*aim)
        game.tick()
        places.append(place_of(game, seat))
        played += [["aim", tick / TICKS, aim], ["at", (tick + 1) / TICKS]]
    assert person.followed()["placed"] == 0
    np.testing.assert_allclose(page.evaluate(PLAY, {"law": person.law, "played": played}), places, atol=1e-5)


def test_a_late_line_changes_nothing_where_the_server_does_the_same(page: Any) -> None:
    """States come 24 ticks after their aims were sent; the page's mallet is where the simulator's will be."""
    game, person = seated(0)
    late, played, states, places = 24, [["take", {**person.followed(), "aim": 0}, 0.0]], [], []
    for tick in range(400):
        aim = [0.45 + 0.2 * math.cos(0.05 * tick), 0.5 + 0.2 * math.sin(0.05 * tick)]
        person.aim(*aim, stamp=1e3 * tick / TICKS)
        game.tick()
        states.append(person.followed())
        places.append(place_of(game, 0))
        played.append(["aim", tick / TICKS, aim])
        if tick >= late:
            played.append(["take", states[tick - late], tick / TICKS])
        played.append(["at", (tick + 1) / TICKS])
    np.testing.assert_allclose(page.evaluate(PLAY, {"law": person.law, "played": played}), places, atol=1e-5)


def test_what_differs_from_the_server_fades_without_a_jump(page: Any) -> None:
    """The server's mallet stands 8 cm away from where the page has it, by an aim that is as old as its own."""
    _, person = seated(0)
    own, state = OwnMotion(), person.followed()
    played: list[list[Any]] = [["take", {**state, "aim": 0}, 0.0], ["aim", 1.0, [0.5, 0.5]]]
    times = [1.5 + k / 60.0 for k in range(60)]
    there = [[0.5, 0.0, 0.0], [0.42, 0.0, 0.0]]
    for time in times:
        played += [["at", time], ["take", {**state, "aim": 1e3 * time, "age": 0, "own": there}, time]]
    found = np.array(page.evaluate(PLAY, {"law": person.law, "played": played}))
    off = found - own.places([(1.0, 0.5, 0.5)], times)
    assert np.hypot(*np.diff(off, axis=0).T).max() < 0.005 and np.hypot(*off.T).max() > 0.0005


def test_a_mallet_that_was_placed_anew_is_there_at_once(page: Any) -> None:
    """And then goes on by the aims of which the server did not know."""
    game, person = seated(0)
    state = person.followed()
    home = [[place, 0.0, 0.0] for place in place_of(game, 0)]
    played = [
        ["take", {**state, "aim": 0}, 0.0], ["aim", 0.0, [0.6, 0.7]], ["at", 1.0],
        ["take", {**state, "aim": 1.0, "age": 120, "own": home, "placed": 1}, 1.1], ["at", 1.1], ["at", 2.0],
    ]  # fmt: skip
    before, placed, after = page.evaluate(PLAY, {"law": person.law, "played": played})
    assert before == pytest.approx([0.6, 0.7], abs=1e-4) == after
    begun = OwnMotion().places([(0.0, 0.6, 0.7)], [1.1 - 0.001 - 1.0])
    assert placed == pytest.approx(begun[0].tolist(), abs=1e-4)


def test_once_the_match_is_over_it_goes_where_the_server_has_it(page: Any) -> None:
    _, person = seated(0)
    there = [[0.4, 0.0, 0.0], [0.3, 0.0, 0.0]]
    played = [
        ["take", {**person.followed(), "aim": 0}, 0.0], ["aim", 0.0, [0.6, 0.7]], ["at", 1.0],
        ["take", {**person.followed(), "own": there, "ending": "points"}, 1.0], ["aim", 1.1, [0.9, 0.9]], ["at", 3.0],
    ]  # fmt: skip
    assert page.evaluate(PLAY, {"law": person.law, "played": played})[1] == pytest.approx([0.4, 0.3], abs=1e-3)


def test_a_goal_places_it_anew() -> None:
    """By the simulator: the opponent's champion scores, and the state says that the mallet was placed."""
    game = Game((PERSON, "policy:champion"), 3)
    assert game.person is not None
    game.person.aim(0.3, 0.2)
    for _ in range(60 * TICKS):
        before = place_of(game, 0)
        game.tick()
        after, home = place_of(game, 0), [0.25, 0.5]
        if sum(game.view().score):
            break
    assert math.dist(before, after) > 0.06 and after == pytest.approx(home)
    assert game.person.followed()["placed"] >= 1
