"""`puckpilot firmware emulate`: a port that others find, and what it refuses in one line."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

import puckpilot

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")


def emulate(*words: str) -> int:
    return puckpilot.main(["firmware", "emulate", "--seconds", "0.2", *words])


def test_a_port_is_there_as_long_as_the_board_lives(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    port = tmp_path / "board"
    port.symlink_to("/dev/pts/of-a-board-that-was-killed")
    assert emulate("--port", str(port), "--place", "0.3", "0.4") == 0
    output = capsys.readouterr().out
    assert f"the board is at {port}" in output and "the mallet is at (0.300, 0.400) m" in output
    assert not port.is_symlink()


@pytest.mark.parametrize("kind", ["file", "link to a file", "dead link to a file", "another board's", "no folder"])
def test_what_is_there_stays_there(kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    port, file = tmp_path / "board", tmp_path / "file"
    own, other = os.openpty()
    {
        "file": lambda: port.write_text("mine"),
        "link to a file": lambda: (file.write_text("mine"), port.symlink_to(file)),
        "dead link to a file": lambda: port.symlink_to(file),
        "another board's": lambda: port.symlink_to(os.ttyname(other)),
        "no folder": lambda: None,
    }[kind]()
    before = sorted(tmp_path.iterdir())
    assert emulate("--port", str(port / "x" if kind == "no folder" else port)) == 2
    output = capsys.readouterr()
    assert str(port) in output.err and output.err.count("\n") == 1 and not output.out
    assert sorted(tmp_path.iterdir()) == before
    os.close(own)
    os.close(other)


@pytest.mark.parametrize("place", [("-1", "0.2"), ("0.1", "nan"), ("5", "5")])
def test_a_place_off_the_table_is_refused(place: tuple[str, str], capsys: pytest.CaptureFixture[str]) -> None:
    assert emulate("--place", *place) == 2
    output = capsys.readouterr()
    assert "expected a place on the table" in output.err and output.err.count("\n") == 1 and not output.out
