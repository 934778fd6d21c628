"""95 % intervals: how many standard deviations they reach on either side of a fitted number."""

from __future__ import annotations

from scipy.stats import t as student

NORMAL_REACH = 1.96  # of a standard deviation that is known
LEAST_FREEDOM = 2  # degrees of freedom; with fewer, an interval would be so wide as to say nothing


def reach(freedom: float) -> float:
    """Standard deviations, of one that was itself fitted with so many degrees of freedom."""
    return float(student.ppf(0.975, freedom))


def reach_of_launches(launches: int) -> float:
    """The same, of one that was taken from the scatter between launches."""
    return reach(max(launches - 1, LEAST_FREEDOM))
