"""Every game of the arena becomes a recording that holds what was played, and a line that says how it ended."""

from __future__ import annotations

import asyncio
import json
import shutil
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

pytest.importorskip("aiohttp", reason="it comes with pip install '.[test]'")

from baselines.matches.played_games import read_pairs
from sim2real.arena import session as session_module
from sim2real.arena.game import PERSON, Game
from sim2real.arena.recordings import records as records_module
from sim2real.arena.recordings.game_recorder import GameRecorder
from sim2real.arena.recordings.records import GAMES, Records
from sim2real.arena.session import Session
from sim2real.recording.folder import read_recording


def played(records: Records, ticks: int, names: tuple[str, str] = ("interceptor", "still")) -> tuple[str, np.ndarray]:
    """The name of a recorded game, and rows (ticks + 1, 7) of time, puck and both mallets as its tables had them."""
    game, rows = Game(names, 5), []
    recorder = records.begin(game, 5)
    for tick in range(ticks + 1):
        if tick:
            game.tick()
            recorder.add(game)
        table = game.tables.states[0]
        axes = [table["mallets"][k][axis] for k in (0, 1) for axis in ("x", "y")]
        mallets = [float(axis["rest"] + axis["slow"] + axis["fast"]) for axis in axes]  # the three parts of its motion
        rows.append([game.ticks / 120, float(table["puck"]["x"]), float(table["puck"]["y"]), *mallets])
    records.keep(recorder, game, 5)
    return recorder.name, np.array(rows)


def test_a_recording_holds_what_was_played(tmp_path: Path) -> None:
    name, rows = played(Records(tmp_path), 300)
    recording = read_recording(tmp_path / name)
    assert recording.frames is not None and recording.mallet is not None
    seen = [recording.frames[key] for key in ("t", "puck_x", "puck_y", "opponent_x", "opponent_y")]
    np.testing.assert_allclose(np.column_stack(seen), rows[:, [0, 1, 2, 5, 6]], atol=1e-6)
    robot = [recording.mallet[key] for key in ("t", "mallet_x", "mallet_y")]
    np.testing.assert_allclose(np.column_stack(robot), rows[:, [0, 3, 4]], atol=1e-6)
    assert recording.nominal("table", "length_m") == pytest.approx(2.0)


@pytest.mark.parametrize(("names", "known"), [((PERSON, "still"), False), (("interceptor", PERSON), True)])
def test_a_quick_mallet_obeys_no_orders_of_a_gantry(names: tuple[str, str], known: bool, tmp_path: Path) -> None:
    """What a diagnosis would take for those of an impossible gantry."""
    game, records = Game(names, 5, quick=True), Records(tmp_path)
    recorder = records.begin(game, 5)
    if game.person is not None:
        game.person.aim(0.4, 0.2, 1.0)
    for _ in range(60):
        game.tick()
        recorder.add(game)
    records.keep(recorder, game, 5)
    recording = read_recording(tmp_path / recorder.name)
    assert recording.mallet is not None and (recording.commands is not None) == known


def test_how_matches_ended_is_a_line_each_under_the_names_of_persons(tmp_path: Path) -> None:
    records = Records(tmp_path, person="ann")
    names = [played(records, 5, (PERSON, "still"))[0], played(records, 5, ("still", PERSON))[0]]
    assert len(set(names)) == 2 and all("human-ann" in name for name in names)
    lines = [json.loads(line) for line in (tmp_path / GAMES).read_text().splitlines()]
    assert [line["players"] for line in lines] == [["human:ann", "still"], ["still", "human:ann"]]
    assert [line["recording"] for line in lines] == names and lines[0]["score"] == [0, 0]
    assert read_pairs(tmp_path / GAMES) == {("human:ann", "still"): [[0, 0]]}


def test_recordings_are_found_by_name_and_nothing_else_is(tmp_path: Path) -> None:
    (other := tmp_path / "elsewhere" / "a table").mkdir(parents=True)
    records = Records(tmp_path / "kept", [other])
    name, _ = played(records, 5)
    assert records.find(name) == tmp_path / "kept" / name and records.find("a table") == other
    (tmp_path / "secret").mkdir()
    (tmp_path / "secret" / "meta.json").write_text("{}")
    for asked in ("", ".", "..", "../secret", "secret", str(tmp_path / "secret"), f"{name}/", f".{name}.tmp", GAMES):
        assert records.find(asked) is None


def left(folder: Path, after: Callable[[], object] = lambda: None) -> None:
    """Play a game that one page looks on to, and end it in the midst, `after` something happened."""

    async def play() -> None:
        session = Session(("interceptor", "still"), 3, Records(folder))
        session.start()
        session.listeners.add(cast(Any, type("Looker", (), {"show": lambda self, state: None})()))
        while session.game.ticks < 30:
            await asyncio.sleep(0.01)
        after()
        await session.close()

    asyncio.run(play())


def test_a_recording_that_cannot_be_completed_is_said_in_a_line(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    def taken() -> None:
        (draft,) = tmp_path.glob(".*.tmp")
        (tmp_path / draft.name[1:].removesuffix(".tmp")).mkdir()

    left(tmp_path, taken)
    said = capsys.readouterr().err
    assert said.startswith("puckpilot arena: a game is not recorded, ") and said.count("\n") == 1
    assert len(list(tmp_path.glob(".*.tmp/frames.csv"))) == 1


def test_a_game_that_is_left_is_kept_as_far_as_it_was_played(tmp_path: Path) -> None:
    left(tmp_path)
    (meta,) = tmp_path.glob("*/meta.json")
    recording = read_recording(meta.parent)
    assert recording.frames is not None and recording.frames.rows >= 30 and not (tmp_path / GAMES).exists()


def test_where_there_is_no_room_play_goes_on_unrecorded_and_says_so_once(
    tmp_path: Path, capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    name, _ = played(Records(tmp_path), 5)
    size = sum(file.stat().st_size for file in (tmp_path / name).iterdir())
    for most, free, why in ((size - 1, 0.0, "of recordings; remove some"), (size, 1e18, "GB free; make room")):
        monkeypatch.setattr(records_module, "MOST", most)
        monkeypatch.setattr(records_module, "LEAST_FREE", free)
        left(tmp_path)  # plays 30 ticks
        said = capsys.readouterr().err
        assert said.startswith("puckpilot arena: a game is not recorded, ") and why in said and said.count("\n") == 1
        assert [path.name for path in tmp_path.glob("*/")] == [name] and not list(tmp_path.glob(".*"))
    monkeypatch.setattr(records_module, "LEAST_FREE", 0.0)
    left(tmp_path)
    assert len(list(tmp_path.glob("*/"))) == 2
    for made in tmp_path.glob("*/"):
        shutil.rmtree(made)
    records = Records(tmp_path)
    played(records, 300)
    with pytest.raises(ValueError, match="remove some"):
        records.begin(Game(("interceptor", "still"), 1), 1)  # by what it recorded itself


def test_a_disk_that_is_full_in_the_midst_of_a_game_stops_the_recording_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(self: object, view: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(session_module.GameRecorder, "add", full)
    monkeypatch.setattr(session_module.Records, "begin", lambda self, game, seed: object.__new__(GameRecorder))
    left(tmp_path)
    said = capsys.readouterr().err
    assert said.count("a game is not recorded, [Errno 28] No space left on device") == 1 == said.count("\n")


def test_a_game_that_is_completed_holds_up_no_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Completing it waits here for the loop to go on."""
    gone_on = threading.Event()

    def finish(self: GameRecorder) -> bool:
        assert gone_on.wait(10.0)
        return False

    async def play() -> None:
        session = Session(("interceptor", "still"), 3, Records(tmp_path))
        session.start()
        session.listeners.add(cast(Any, type("Looker", (), {"show": lambda self, state: None})()))
        while session.game.ticks < 5:
            await asyncio.sleep(0.01)
        closing = asyncio.create_task(session.close())
        await asyncio.sleep(0.01)
        gone_on.set()
        await closing

    monkeypatch.setattr(GameRecorder, "finish", finish)
    asyncio.run(play())


def test_what_a_killed_server_left_is_finished_by_the_next(tmp_path: Path) -> None:
    records = Records(tmp_path)
    game = Game(("interceptor", "still"), 1)
    recorder = records.begin(game, 1)
    for _ in range(150):
        game.tick()
        recorder.add(game)
    assert records.find(recorder.name) is None
    Records(tmp_path)  # the first still has it
    assert records.find(recorder.name) is None
    del recorder  # as the end of a process does, it gives up the lock
    Records(tmp_path)
    (meta,) = tmp_path.glob("[!.]*/meta.json")
    frames = read_recording(meta.parent).frames
    assert frames is not None and frames.rows == 120
