"""The draft of a recording: whole or not at all, refused where something is, finished after a killed run."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from sim2real.recording.folder import RecordingError, read_recording
from sim2real.table.recorder.draft import RecordingDraft, columns, refuse_existing
from tests.places import ROOT

META = {
    "format": "puckpilot-recording/1", "table": {"length_m": 2.0}, "puck": {}, "mallet": {}, "camera": {},
    "note": "test",
}  # fmt: skip
KILLED = """
import os, signal
from pathlib import Path
from sim2real.table.recorder.draft import RecordingDraft
from tests.sim2real.table.recorder.test_draft import META
draft = RecordingDraft(Path("one"), META)
draft.add("mallet", [(0.001 * k, 0.5, 0.5, 0.5, 0.5) for k in range(20)])
draft._files["mallet"].write("0.9,0.5")
draft._files["mallet"].flush()
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_rows_come_back_and_an_empty_stream_is_left_out(tmp_path: Path) -> None:
    draft = RecordingDraft(tmp_path / "one", META)
    draft.add("frames", [(0.0, 0.1, 0.2, math.nan, math.nan), (0.01, math.nan, math.nan, 1.5, 0.5)])
    assert not (tmp_path / "one").exists()
    assert draft.finish() and [path.name for path in tmp_path.iterdir()] == ["one"]
    found = read_recording(tmp_path / "one")
    assert found.frames is not None and set(found.streams()) == {"frames"}
    np.testing.assert_array_equal(found.frames["puck_x"], [0.1, math.nan])
    assert tuple(found.frames) == columns("frames")


def test_a_row_that_is_not_later_is_left_out(tmp_path: Path) -> None:
    draft = RecordingDraft(tmp_path / "one", META)
    draft.add("drive", [(0.0, 0.1, 0.1), (0.001, 0.2, 0.2), (0.001, 0.3, 0.3), (0.0009, 0.4, 0.4), (0.002, 0.5, 0.5)])
    draft.finish()
    drive = read_recording(tmp_path / "one").drive
    assert drive is not None and drive["pwm_left"].tolist() == [0.1, 0.2, 0.5]


def test_without_rows_nothing_is_left(tmp_path: Path) -> None:
    assert not RecordingDraft(tmp_path / "one", META).finish()
    assert not list(tmp_path.iterdir())


def test_without_rows_no_folder_is_left_that_was_made_for_it(tmp_path: Path) -> None:
    (tmp_path / "mine").mkdir()
    assert not RecordingDraft(tmp_path / "mine" / "games" / "all" / "game_1", META).finish()
    assert not list((tmp_path / "mine").iterdir())
    assert not RecordingDraft(tmp_path / "mine" / "game_1", META).finish()
    assert not list((tmp_path / "mine").iterdir())


def test_a_folder_that_was_made_for_a_draft_stays_for_another_one_s_rows(tmp_path: Path) -> None:
    empty, other = (RecordingDraft(tmp_path / "all" / f"game_{number}", META) for number in (1, 2))
    other.add("drive", [(0.0, 0.1, 0.1)])
    assert not empty.finish() and other.finish()
    assert [path.name for path in (tmp_path / "all").iterdir()] == ["game_2"]


def test_what_exists_is_refused(tmp_path: Path) -> None:
    (tmp_path / "one").mkdir()
    with pytest.raises(RecordingError, match="one: exists already; choose another name or remove it"):
        RecordingDraft(tmp_path / "one", META)


def test_a_second_run_of_the_same_name_is_refused(tmp_path: Path) -> None:
    draft = RecordingDraft(tmp_path / "one", META)
    with pytest.raises(RecordingError, match="is being recorded by another run; choose another name"):
        RecordingDraft(tmp_path / "one", META)
    draft.add("drive", [(0.0, 0.1, 0.1)])
    assert draft.finish()


@pytest.mark.slow
def test_what_a_killed_run_left_is_finished_by_the_next_one(tmp_path: Path) -> None:
    killed = subprocess.run([sys.executable, "-c", KILLED], cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT)})
    assert killed.returncode == -signal.SIGKILL and not (tmp_path / "one").exists()
    with pytest.raises(
        RecordingError, match="one: is what a killed run had recorded, complete now; choose another name"
    ):
        RecordingDraft(tmp_path / "one", META)
    mallet = read_recording(tmp_path / "one").mallet
    assert mallet is not None and mallet.rows == 20  # without the row that was cut off
    assert [path.name for path in tmp_path.iterdir()] == ["one"]


def test_what_a_killed_run_left_of_several_games_is_finished(tmp_path: Path) -> None:
    draft = RecordingDraft(tmp_path / "all" / "game_2", META)
    draft.add("drive", [(0.0, 0.1, 0.1)])
    draft._meta.close()  # as if it were killed: the lock is gone
    with pytest.raises(RecordingError, match="all: exists already"):
        refuse_existing(tmp_path / "all")
    assert [path.name for path in (tmp_path / "all").iterdir()] == ["game_2"]
