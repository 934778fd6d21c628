"""What the flashed program's ticks take, counted in the emulator."""

from __future__ import annotations

import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from sim2real.emulate.tick_instructions import count_ticks

MOST = 12_000  # instructions: at 1.5 cycles each a quarter of the millisecond


def test_no_tick_takes_more_than_a_quarter_of_its_time_whatever_the_line_brings() -> None:
    found = count_ticks()
    floods = [what for what in found if "line full" in what]
    assert len(floods) == 3 and all(found["play"] < found[what] for what in floods)
    assert 2 * found["nothing to do"] < found["play"] < found["play, a new trajectory"]
    assert max(found.values()) <= MOST, found
