"""A recording is diagnosed where its page asks for it, for those who know the token; what was concealed comes after."""

from __future__ import annotations

import asyncio
import json
import os
import sys
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest

from puckpilot_env.batch.motion import puck_motion

pytest.importorskip("aiohttp", reason="it comes with pip install '.[test]'")
from aiohttp.test_utils import TestClient, TestServer

import sim2real
from sim2real.arena.concealed import TABLES, draw
from sim2real.arena.game import PERSON, Game, concealed_game
from sim2real.arena.lobby import Lobby
from sim2real.arena.recordings import diagnoser
from sim2real.arena.recordings.records import GAMES, Records
from sim2real.arena.server import make_app
from tests.sim2real.arena.recordings.made_diagnosis import LINES, REPORT, write_diagnosis

TOKEN = "a-token"
DEMO = Path(sim2real.__file__).with_name("demo_recording")
EFFECTS = {"table_tilt": {"tilt_x": 0.02, "tilt_y": -0.012}}
Check = Callable[[Any], Awaitable[None]]


def served(check: Check, records: Records, **diagnoses: Path) -> None:
    """Run a check against a server of the test's own."""

    async def run() -> None:
        app = make_app(Lobby((PERSON, "still"), 0, records), records, TOKEN, diagnoses)
        async with TestClient(TestServer(app)) as client:
            await check(client)

    asyncio.run(asyncio.wait_for(run(), 120.0))


def instead(monkeypatch: pytest.MonkeyPatch, script: str) -> None:
    """Let a script be run in place of the diagnosis; `recording` and `out` are its folders."""
    begin = "import sys, os, time, pathlib; _, recording, _, out = sys.argv; out = pathlib.Path(out); "
    monkeypatch.setattr(diagnoser, "COMMAND", (sys.executable, "-c", begin + script))


async def asked(client: Any, name: str, method: str = "GET") -> dict[str, Any]:
    """How far the diagnosis of a recording is."""
    answer = await client.request(method, "/diagnosis", params={"name": name, "token": TOKEN})
    assert answer.status == 200
    return await answer.json()


async def until(client: Any, name: str, state: str) -> dict[str, Any]:
    """The answer once the diagnosis is so far."""
    while (found := await asked(client, name))["state"] != state:
        await asyncio.sleep(0.05)
    return found


def test_strangers_and_names_that_are_none_are_refused(tmp_path: Path) -> None:
    async def check(client: Any) -> None:
        for method, path in (("GET", "/diagnosis"), ("POST", "/diagnosis"), ("GET", "/diagnosed"), ("GET", "/report")):
            assert (await client.request(method, path, params={"name": DEMO.name})).status == 403
            assert (await client.request(method, path, params={"name": DEMO.name, "token": "another"})).status == 403
            for name in ("", "..", f"../{DEMO.name}", "none"):
                assert (await client.request(method, path, params={"name": name, "token": TOKEN})).status == 404
        assert await asked(client, DEMO.name) == {"state": "none", "words": ""}
        assert (await client.get("/diagnosed", params={"name": DEMO.name, "token": TOKEN})).status == 404

    served(check, Records(tmp_path, [DEMO]))
    assert not (tmp_path / "diagnoses").exists()


@pytest.mark.slow
def test_a_diagnosis_that_is_given_is_shown(tmp_path: Path) -> None:
    async def check(client: Any) -> None:
        assert await asked(client, DEMO.name, "POST") == {"state": "there", "words": "", "concealed": None}
        answer = await client.get("/diagnosed", params={"name": DEMO.name, "token": TOKEN})
        found = await answer.json()
        assert found["summary"] == LINES and len(found["glides"]) > 10 and len(found["contacts"]) > 10

    served(check, Records(tmp_path, [DEMO]), demo_recording=write_diagnosis(tmp_path / "found", EFFECTS))


def test_the_report_is_shown_and_nothing_in_it_runs(tmp_path: Path) -> None:
    found = write_diagnosis(tmp_path / "found", EFFECTS)

    async def check(client: Any) -> None:
        answer = await client.get("/report", params={"name": DEMO.name, "token": TOKEN})
        assert answer.status == 200 and answer.content_type == "text/html" and await answer.text() == REPORT
        policy = answer.headers["Content-Security-Policy"]
        assert "default-src 'none'" in policy and "script-src" not in policy
        (found / "report.html").unlink()
        missing = await client.get("/report", params={"name": DEMO.name, "token": TOKEN})
        assert missing.status == 404 and "report cannot be read" in await missing.text()

    served(check, Records(tmp_path, [DEMO]), demo_recording=found)


@pytest.mark.slow
def test_a_diagnosis_that_fails_says_why_and_can_be_asked_for_again(tmp_path: Path) -> None:
    (broken := tmp_path / "broken").mkdir()
    (broken / "meta.json").write_text("{}")

    async def check(client: Any) -> None:
        for _ in range(2):
            assert (await asked(client, "broken", "POST"))["state"] == "going"
            failed = await until(client, "broken", "failed")
            assert failed["words"].startswith("puckpilot diagnose: ") and "format" in failed["words"]
        assert (await client.get("/recording", params={"name": DEMO.name, "token": TOKEN})).status == 200

    served(check, Records(tmp_path / "out", [broken, DEMO]))


def begun_in(folder: Path) -> list[Path]:
    return list((folder / "out").glob("diagnoses/*/pid"))


def test_they_go_on_one_at_a_time_and_end_with_the_server(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    instead(monkeypatch, "out.mkdir(parents=True); (out / 'pid').write_text(f'{os.getpid()} '); time.sleep(600)")
    (other := tmp_path / "other").mkdir()
    (other / "meta.json").write_text("{}")
    begun: list[int] = []

    async def check(client: Any) -> None:
        for name in (DEMO.name, DEMO.name, "other"):
            await asked(client, name, "POST")
        while not (found := [path for path in begun_in(tmp_path) if path.read_text().endswith(" ")]):
            await asyncio.sleep(0.02)
        begun.append(int(found[0].read_text()))
        assert os.getpriority(os.PRIO_PROCESS, begun[0]) == diagnoser.LOWEST_PRIORITY
        assert (await asked(client, DEMO.name))["words"].startswith("diagnosing for ")
        assert (await asked(client, "other"))["words"] == "waiting for another diagnosis"

    served(check, Records(tmp_path / "out", [DEMO, other]))
    (only,) = begun_in(tmp_path)
    assert only.parent.name.startswith(f"{DEMO.name}-")
    with pytest.raises(ProcessLookupError):
        os.kill(begun[0], 0)


def concealed(records: Records, seed: int) -> str:
    """The name of the recording of a short game on a table of which something is concealed."""
    game = concealed_game(("interceptor", "still"), seed)
    recorder = records.begin(game, seed)
    for _ in range(30):
        game.tick()
        recorder.add(game)
    records.keep(recorder, game, seed)
    return recorder.name


@pytest.mark.slow
def test_what_was_concealed_is_said_after_the_diagnosis_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = write_diagnosis(tmp_path / "made", EFFECTS)
    go_on = tmp_path / "go on"
    wait = f"go_on = pathlib.Path({str(go_on)!r})\nwhile not go_on.exists(): time.sleep(0.02)\n"
    instead(monkeypatch, f"import shutil\n{wait}shutil.copytree({str(made)!r}, out, copy_function=shutil.copy)")
    records = Records(tmp_path / "out")
    seed = next(seed for seed in range(100) if draw(seed).mechanism == "table_tilt")
    name = concealed(records, seed)

    async def check(client: Any) -> None:
        assert "concealed" not in await asked(client, name)
        assert "concealed" not in await asked(client, name, "POST")
        recording = await client.get("/recording", params={"name": name, "token": TOKEN})
        assert "tilt" not in await recording.text()
        for path in (f"/concealed/{name}.json", f"/recording?name=concealed&token={TOKEN}"):
            assert (await client.get(path)).status in (403, 404)
        go_on.touch()
        found = (await until(client, name, "there"))["concealed"]
        assert found["mechanism"] == "table_tilt" and found["words"] == draw(seed).words
        (tmp_path / "out" / "diagnoses" / name / "diagnosis.json").unlink()
        assert "concealed" not in await asked(client, name)

    served(check, records)


def test_a_recording_says_nothing_of_what_is_concealed_and_no_rating_counts_it(tmp_path: Path) -> None:
    records = Records(tmp_path)
    seeds = [next(seed for seed in range(100) if draw(seed) is table) for table in TABLES[:2]]
    metas = [json.loads((tmp_path / concealed(records, seed) / "meta.json").read_text()) for seed in seeds]
    for meta in metas:  # nor the seed, of which it is drawn
        assert meta.pop("note") == "arena: interceptor (the robot's seat) and still; exact positions"
    assert metas[0] == metas[1] and not (tmp_path / GAMES).exists()


def test_a_concealed_table_is_played_on_and_the_seed_draws_it() -> None:
    plain, tilted = Game(("still", "still"), 3), Game(("still", "still"), 3, TABLES[1])
    assert plain.concealed is None and TABLES[1].parameters["tilt_y"] < 0.0
    for game in (plain, tilted):
        for _ in range(60):
            game.tick()
    (_, down), (_, level) = (puck_motion(game.tables.states[0])[:2] for game in (tilted, plain))
    assert down < level - 0.01
    assert {draw(seed).words for seed in range(200)} == {table.words for table in TABLES}


def test_a_diagnosis_is_of_one_recording_and_no_newer_one(tmp_path: Path) -> None:
    """Two recordings of one name, as `play --record` makes them; and one that was made anew."""
    found = diagnoser.Diagnoser(tmp_path / "out" / "diagnoses", {})
    for place in (one := tmp_path / "monday" / "game_1", other := tmp_path / "friday" / "game_1"):
        place.mkdir(parents=True)
        (place / "meta.json").write_text("{}")
    assert found.find("game_1", one) is None
    (made := found._place("game_1", one)).mkdir(parents=True)
    (made / "diagnosis.json").write_text("{}")
    assert found.find("game_1", one) == made and found.find("game_1", other) is None
    later = (made / "diagnosis.json").stat().st_mtime + 1.0
    os.utime(one / "meta.json", (later, later))
    assert found.find("game_1", one) is None
