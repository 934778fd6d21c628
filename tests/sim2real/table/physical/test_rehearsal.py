"""A rehearsal's board, emulated in a process of its own: its port, or the reason why there is none."""

from __future__ import annotations

import multiprocessing
from pathlib import Path

import pytest

from sim2real.table.backend import Place
from sim2real.table.physical import rehearsal

HOME = (0.2, 0.5)


@pytest.mark.slow
def test_the_board_has_a_port_while_it_is_emulated() -> None:
    pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")
    with rehearsal.emulated_board(HOME) as port:
        assert Path(port).exists()


def test_why_a_board_cannot_be_emulated_is_passed_on(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(place: Place) -> None:
        raise ImportError("no module named 'unicorn'")

    monkeypatch.setattr(rehearsal, "_machine", fails)
    here, there = multiprocessing.Pipe()
    rehearsal._serve_board(there, HOME)
    assert "no module named 'unicorn'" in str(here.recv())
