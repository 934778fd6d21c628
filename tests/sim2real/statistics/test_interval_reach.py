"""Reaches of 95 % intervals, against printed tables of Student's t."""

import pytest

from sim2real.statistics.intervals import NORMAL_REACH, reach, reach_of_launches


@pytest.mark.parametrize(("freedom", "printed"), [(2, 4.303), (9, 2.262), (30, 2.042), (1e9, NORMAL_REACH)])
def test_reaches_are_those_of_the_tables(freedom: float, printed: float) -> None:
    assert reach(freedom) == pytest.approx(printed, abs=5e-4)


@pytest.mark.parametrize(("launches", "printed"), [(1, 4.303), (3, 4.303), (10, 2.262)])
def test_launches_lose_one_to_the_mean_and_never_leave_less_than_two(launches: int, printed: float) -> None:
    assert reach_of_launches(launches) == pytest.approx(printed, abs=5e-4)
