"""A rehearsal's board, emulated in a process of its own: its port, or the reason why there is none."""

from __future__ import annotations

import multiprocessing
import sys
from pathlib import Path

import pytest

from sim2real.table.physical import rehearsal

HOME = (0.2, 0.5)


@pytest.mark.slow
def test_the_board_has_a_port_while_it_is_emulated() -> None:
    pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")
    with rehearsal.emulated_board(HOME) as port:
        assert Path(port).exists()


def test_why_a_board_cannot_be_emulated_is_passed_on(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [one for one in sys.modules if one.startswith("sim2real.emulate")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "unicorn", None)  # as if it were not installed
    here, there = multiprocessing.Pipe()
    rehearsal._serve_board(there, HOME)
    assert "unicorn" in str(here.recv())
