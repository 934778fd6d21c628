"""Times of decisions, counted and drawn."""

from __future__ import annotations

import math

from sim2real.table.game.loop_times import LoopTimes, histogram, summary


def test_overruns_are_counted_and_games_joined() -> None:
    one, other = LoopTimes(), LoopTimes()
    for late in (0.0, 0.001, 0.0049, 0.0051, 0.2):
        one.add(late, 0.006)
    other.add(0.006, math.nan)
    one.join(other)
    assert one.overruns == 3 and len(one.lateness) == 6


def test_a_summary_leaves_out_what_is_none() -> None:
    found = summary("age", [0.001, 0.002, 0.003, math.nan])
    assert found == {"age_median": 0.002, "age_p99": 0.00298, "age_max": 0.003}
    assert all(math.isnan(value) for value in summary("age", []).values())


def test_a_histogram_has_all_counts_and_its_longest_bar_at_the_fullest_bin() -> None:
    lines = histogram("late", [0.0001] * 30 + [0.0119] * 10 + [5.0])
    assert lines[0] == "late [ms], 41 in all"
    counts = [int(line.replace("#", "").split()[-1]) for line in lines[1:]]
    assert sum(counts) == 41 and lines[1].endswith("#" * 40)
    assert histogram("late", []) == ["late: none"]
