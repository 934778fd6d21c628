"""The reported pace of a run."""

from __future__ import annotations

import pytest

from agents.commands.progress_display import _cells, pace


def test_pace_is_the_median_over_rounds() -> None:
    columns = ("steps_per_s", "environment", "acting", "learning")
    rounds = [(9000, 0.5, 0.25, 0.25), (120400, 0.125, 0.175, 0.7), (130000, 0.1, 0.19, 0.71)]
    rows: list[dict[str, float]] = [dict(zip(columns, one, strict=True)) for one in rounds]
    assert pace(rows) == "120,400 steps/s, 12 % environment, 19 % acting, 70 % learning"


@pytest.mark.parametrize(("rating", "shown"), [(-0.3, "+0"), (0.2, "+0"), (-12.6, "-13"), (40.4, "+40")])
def test_a_rating_is_shown_without_a_negative_zero(rating: float, shown: str) -> None:
    row = {"round": 1, "steps": 1, "seconds": 60.0, "steps_per_s": 1, "selves": 1, "rating": rating}
    assert _cells(row)["rating"] == shown
