"""Files that are there whole or not at all, whoever ends the process that makes them."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from puckpilot_env.files.whole_file import check_folder, write_text_whole, write_whole
from puckpilot_env.rendering.video import VideoWriter
from tests.places import ROOT

FILM = ["match", "still", "still", "--games", "2", "--variant", "match-v0", "--video"]

# Tests that run in the background, or under nohup, hand down signals that are ignored.
AS_FROM_A_TERMINAL = (
    "import signal, sys; from puckpilot import main; "
    "signal.signal(signal.SIGINT, signal.default_int_handler); "
    "[signal.signal(number, signal.SIG_DFL) for number in (signal.SIGTERM, signal.SIGHUP)]; "
    "sys.exit(main())"
)


@pytest.mark.parametrize("before", [None, "old"])
def test_a_failing_writer_leaves_what_was_there(tmp_path: Path, before: str | None) -> None:
    def fail(path: Path) -> None:
        path.write_text("half")
        raise OSError("disk full")

    if before:
        (tmp_path / "a.json").write_text(before)
    with pytest.raises(OSError, match="disk full"):
        write_whole(tmp_path / "a.json", fail)
    assert [path.read_text() for path in tmp_path.iterdir()] == ([before] if before else [])


def test_nothing_half_written_is_in_its_place(tmp_path: Path) -> None:
    place = tmp_path / "a.txt"
    seen = []

    def write(draft: Path) -> None:
        draft.write_text("half")
        seen.append(place.exists())
        draft.write_text("whole ½")

    assert write_whole(place, write) == place and seen == [False]
    assert place.read_text() == "whole ½"
    assert write_text_whole(place, "new ½").read_text(encoding="utf-8") == "new ½"
    assert list(tmp_path.iterdir()) == [place]


@pytest.mark.parametrize("place", ["missing/a.json", "folder"])
def test_an_error_names_the_place_and_not_the_draft(tmp_path: Path, place: str) -> None:
    (tmp_path / "folder").mkdir()
    with pytest.raises(OSError) as caught:
        write_text_whole(tmp_path / place, "text")
    assert caught.value.filename == str(tmp_path / place)
    assert list(tmp_path.iterdir()) == [tmp_path / "folder"]


def _begin_film(place: Path) -> subprocess.Popen[str]:
    """A process that films a game, stopped by the caller once its draft has appeared."""
    film = subprocess.Popen(
        [sys.executable, "-c", AS_FROM_A_TERMINAL, *FILM, str(place)], cwd=ROOT, stderr=subprocess.PIPE, text=True
    )
    while not list(place.parent.glob(".*")) and film.poll() is None:
        time.sleep(0.01)
    assert film.poll() is None, film.communicate()
    return film


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_film_that_is_stopped_leaves_nothing(tmp_path: Path, number: signal.Signals) -> None:
    film = _begin_film(tmp_path / "a.mp4")
    film.send_signal(number)
    printed = film.communicate(timeout=240)[1]
    assert film.returncode == 128 + number
    assert printed.splitlines()[-1] == "puckpilot match: stopped" and "Traceback" not in printed
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_what_a_killed_film_left_goes_with_the_next(tmp_path: Path) -> None:
    film = _begin_film(tmp_path / "a.mp4")
    film.kill()
    film.communicate(timeout=240)
    assert len(list(tmp_path.glob(".*"))) == len(list(tmp_path.iterdir())) == 1
    with pytest.raises(ValueError, match="no frames"), VideoWriter(tmp_path / "a.mp4"):
        pass
    assert not list(tmp_path.iterdir())


def test_a_folder_is_looked_at_and_nothing_is_left(tmp_path):
    check_folder(tmp_path / "a" / "b")
    check_folder(tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("place", ["file", "file/a/b"])
def test_a_file_is_no_folder(place, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(ValueError, match="file is a file; give a folder"):
        check_folder(tmp_path / place)
