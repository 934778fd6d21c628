"""A person at the terminal: what is asked for, and that the table is served meanwhile."""

from __future__ import annotations

import os
import threading

import numpy as np
import pytest

from sim2real.table.faults import Cause, TableFaultError
from sim2real.table.physical.person import PersonAtTerminal, may_go_on


class Terminal:
    """A standard input at which Enter is pressed, or which is closed, once the table was served three times."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, typed: bytes) -> None:
        reads, self._writes = os.pipe()
        monkeypatch.setattr("sys.stdin", os.fdopen(reads))
        self._typed, self.served = typed, 0

    def serve(self) -> None:
        self.served += 1
        if self.served == 3:
            os.write(self._writes, self._typed)
            os.close(self._writes)


def test_the_table_is_served_until_enter_is_pressed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    terminal = Terminal(monkeypatch, b"\n")
    PersonAtTerminal(terminal.serve).home_mallet((0.25, 0.5))
    assert terminal.served == 3
    assert "mallet at (0.250, 0.500) m by hand" in capsys.readouterr().err


def test_a_closed_terminal_is_no_enter(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(TableFaultError, match="nobody pressed Enter") as caught:
        PersonAtTerminal(Terminal(monkeypatch, b"").serve).home_mallet((0.25, 0.5))
    assert caught.value.cause == Cause.NOT_READY


@pytest.mark.parametrize(("velocity", "words"), [((0.0, 0.0), "let it lie"), ((0.3, -0.4), "about 0.5 m/s")])
def test_a_puck_is_asked_for_with_its_speed(
    velocity: tuple[float, float], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    PersonAtTerminal(lambda: None).put_puck(np.array([1.0, 0.4, *velocity]))
    said = capsys.readouterr().err
    assert "(1.00, 0.40) m" in said and words in said


FAULT = TableFaultError(Cause.NOT_READY, "the camera is unplugged")


@pytest.mark.parametrize(("typed", "goes_on"), [(b"\n", True), (b"\x04", False)], ids=["Enter", "end of input"])
def test_after_a_fault_the_person_is_asked_whether_to_go_on(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], typed: bytes, goes_on: bool
) -> None:
    """What was typed before the question is no answer to it."""
    terminal, side = os.openpty()
    monkeypatch.setattr("sys.stdin", os.fdopen(side))
    os.write(terminal, b"\n")
    threading.Timer(0.3, os.write, (terminal, typed)).start()
    assert may_go_on(FAULT) == goes_on
    assert "the camera is unplugged. Press Enter to go on, Ctrl-C to end" in capsys.readouterr().err


def test_where_nobody_can_answer_play_does_not_go_on(monkeypatch: pytest.MonkeyPatch) -> None:
    Terminal(monkeypatch, b"\n").serve()
    assert not may_go_on(FAULT)
