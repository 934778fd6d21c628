"""Tables line up and hold the right numbers; the picture is written, and is the same each time."""

from __future__ import annotations

from io import StringIO

import numpy as np
import pytest
from rich.console import Console

from baselines.matches.payoff import Payoff
from baselines.matches.payoff_table import draw_payoff, payoff_table, rating_table
from baselines.ratings.rating import Ratings


def test_tables_hold_the_counts_and_the_picture_is_deterministic(tmp_path):
    payoff = Payoff(
        ("[b]ace", "mid", "low"),
        np.array([[0, 120, 9], [7, 0, 0], [1, 0, 0]]),
        np.array([[0, 3, 2], [3, 0, 0], [2, 0, 0]]),
    )
    ratings = Ratings(payoff.players, (200.4, -50.0, -150.4), (150.0, -90.0, -300.0), None, 0.1)
    console = Console(width=120, file=StringIO())
    with console.capture() as printed:
        console.print(payoff_table(payoff), rating_table(ratings))
    lines = printed.get().splitlines()
    heading = next(row for row, line in enumerate(lines) if line.split() == list(payoff.players))
    ace, mid, low = (line.rstrip() for line in lines[heading + 2 : heading + 5])
    assert ace.split(maxsplit=2) == ["[b]ace", "-", "120/  3/  7     9/  2/  1"]
    assert len(ace) == len(mid) == len(low) and mid.endswith("-") and low.split(maxsplit=1)[0] == "low"
    assert any(line.split() == ["[b]ace", "+200", "+150", "?"] for line in lines)
    draw_payoff(tmp_path / "one.png", payoff, ratings)
    draw_payoff(tmp_path / "two.png", payoff, ratings)
    assert (tmp_path / "one.png").read_bytes()[:4] == b"\x89PNG"
    assert (tmp_path / "one.png").read_bytes() == (tmp_path / "two.png").read_bytes()
    with pytest.raises(ValueError, match="do not match"):
        draw_payoff(tmp_path / "no.png", Payoff(("a", "b"), np.zeros((2, 2)), np.zeros((2, 2))), ratings)
