"""95 % intervals: how many standard deviations they reach on either side of a fitted number."""

from __future__ import annotations

from dataclasses import dataclass

from scipy.stats import t as student

from sim2real.statistics.tuned import tuned

NORMAL_REACH = 1.96  # of a standard deviation that is known


@dataclass(frozen=True)
class IntervalNumbers:
    """Tuned numbers of intervals."""

    least_freedom: int = tuned(
        2, "degrees of freedom", "intervals so wide that they say nothing", "choice: of one, they reach 12.7"
    )


INTERVALS = IntervalNumbers()


def reach(freedom: float) -> float:
    """Half width in standard deviations, where that deviation was itself fitted with so many degrees of freedom."""
    return float(student.ppf(0.975, freedom))


def reach_of_launches(launches: int) -> float:
    """The same, where that deviation is the scatter between so many launches."""
    return reach(max(launches - 1, INTERVALS.least_freedom))
