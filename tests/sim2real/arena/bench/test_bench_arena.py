"""`puckpilot bench arena`: a page behind a bad line stays playable, and what is measured is printed."""

from __future__ import annotations

import asyncio
import json
import shutil

import numpy as np
import pytest
from numpy.typing import NDArray

pytest.importorskip("aiohttp", reason="it comes with pip install '.[test]'")

import puckpilot
from sim2real.arena.bench import pictures
from sim2real.arena.bench.bad_line import bad_line
from sim2real.arena.bench.measure import LOSS
from sim2real.arena.bench.pictures import Seen
from sim2real.commands import bench_arena
from tests.sim2real.arena.running import arena

HAS_BROWSER = any(map(shutil.which, pictures.BROWSERS))


@pytest.mark.slow
@pytest.mark.skipif(not HAS_BROWSER, reason="no Chromium is installed")
def test_behind_a_bad_line_the_mallet_moves_as_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pictures, "CIRCLES", 4.0)

    async def play(address: str) -> Seen:
        port = int(address.split(":")[2].split("/")[0])
        async with pictures.browser() as opened, bad_line(port, 0.1, LOSS, 1) as entry:
            return await pictures.watched(opened, address.replace(f":{port}/", f":{entry}/"), 5, 1)

    with arena("still") as address:
        seen = asyncio.run(play(address))
    jump, farthest = seen.beyond()
    gone = np.ptp(seen.pictures[:, 2:], axis=0)
    assert jump < 0.005 and farthest < 0.02 and gone.min() > 0.2  # it went the circle
    assert all(delay > 0.0 for delay in seen.delays())


@pytest.mark.slow
def test_without_a_browser_the_rest_is_measured(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture) -> None:
    monkeypatch.setattr(pictures, "BROWSERS", ())
    assert puckpilot.main(["bench", "arena", "still", "--seconds", "1", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["lines"] == [] and result["no_browser"] == "there is no Chromium"
    assert result["load"]["states_a_second"]["least"] > 0.0 and result["load"]["server"]["games"] == 4
    lines = bench_arena.lines_of(result)
    assert lines[0] == "from the pointer to the picture: not measured, there is no Chromium"
    assert lines[1].startswith("4 games and 20 who look on, 1 s: to each page ") and len(lines) == 4


def test_delays_and_jumps_of_made_up_pictures() -> None:
    """Pictures each 10 ms: one shows a leap 30 ms later; in one the mallet is 8 mm off."""
    times = np.arange(200) * 0.01

    def pictures(late: float) -> NDArray[np.float64]:
        return np.column_stack([times + late, times, places]).astype(np.float64)

    places = np.full((200, 2), (0.25, 0.5))
    places[:, 0] += np.where(times > 1.525, 0.05, 0.0)
    seen = Seen([1.501], pictures(0.002), [(0.0, 0.25, 0.5)])
    assert seen.delays() == pytest.approx([1.532 - 1.501])
    assert seen.beyond()[1] > 0.04
    places[:, 0], places[150, 1] = 0.25, 0.508
    still = Seen([], pictures(0.0), [(0.0, 0.25, 0.5)])
    assert still.beyond() == pytest.approx((0.008, 0.008), abs=1e-4)
    still.over, seen.over = 1.49, 1.5
    assert still.beyond() == pytest.approx((0.0, 0.0), abs=1e-4) and seen.delays() == []


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["goaly"], "unknown player 'goaly'; did you mean 'goalie'?"),
        (["--leaps", "0"], "--leaps is 0; expected a whole number from 1 to 10,000"),
        (["--seconds", "0"], "--seconds is 0; expected 1 to 86400"),
    ],
)
def test_mistakes_get_one_line(words: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert puckpilot.main(["bench", "arena", *words]) == 2
    error = capsys.readouterr().err
    assert error.startswith("puckpilot bench arena: ") and message in error and error.count("\n") == 1
