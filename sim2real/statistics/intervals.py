"""Half widths of 95 % intervals in standard deviations."""

from __future__ import annotations

from dataclasses import dataclass

from scipy.stats import t as student

from sim2real.statistics.tuned import tuned

NORMAL_REACH = 1.96  # for a known standard deviation


@dataclass(frozen=True)
class IntervalNumbers:
    """Tuned numbers of intervals."""

    least_freedom: int = tuned(
        2, "degrees of freedom", "intervals too wide to be useful", "choice: with one, the half width is 12.7"
    )


INTERVALS = IntervalNumbers()


def reach(freedom: float) -> float:
    """Half width in standard deviations, for a standard deviation estimated with `freedom` degrees of freedom."""
    return float(student.ppf(0.975, freedom))


def reach_of_launches(launches: int) -> float:
    """Half width in standard deviations, for a standard deviation estimated from the scatter between `launches`."""
    return reach(max(launches - 1, INTERVALS.least_freedom))
