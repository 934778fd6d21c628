"""The figures of a study: shares and medians with 95 % intervals and their acceptance limits."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from sim2real.study.scoring import NOTHING_MISSING, Score

FEWEST = 5  # fewest cases or numbers for a decision on an acceptance limit
LONG = 60.0  # s, least length of a recording for the stricter limit for one effect


@dataclass(frozen=True)
class Figure:
    """`value` of `count` cases (or numbers) with its 95 % interval; the acceptance limits are [least, most]."""

    name: str
    value: float | None
    low: float
    high: float
    count: int
    least: float
    most: float

    @property
    def reached(self) -> bool | None:
        """Whether the value lies within the limits; None if there are too few cases."""
        return None if self.value is None or self.too_few else self._within(self.value)

    @property
    def too_few(self) -> bool:
        """Whether there are cases, but too few for a meaningful value."""
        return 0 < self.count < FEWEST

    @property
    def sure(self) -> bool | None:
        """Whether the entire interval gives the same decision as the value; None if there are too few cases."""
        if self.value is None or self.too_few:
            return None
        if self._within(self.value):
            return self._within(self.low) and self._within(self.high)
        return self.high < self.least or self.low > self.most

    def _within(self, value: float) -> bool:
        return self.least <= value <= self.most

    def as_dict(self) -> dict[str, Any]:
        """The figure as plain data; None for infinite values."""
        plain = {name: None if value in (-np.inf, np.inf) else value for name, value in asdict(self).items()}
        return {**plain, "reached": self.reached, "sure": self.sure}


def share(name: str, answers: Iterable[bool | None], least: float = 0.0, most: float = 1.0) -> Figure:
    """The share of True among the answers that are not None, with the interval of Clopper and Pearson
    (see `baselines.ratings.intervals`)."""
    from scipy.stats import binomtest

    known = [answer for answer in answers if answer is not None]
    if not known:
        return Figure(name, None, 0.0, 1.0, 0, least, most)
    interval = binomtest(sum(known), len(known)).proportion_ci(0.95, "exact")
    low, high = float(interval.low), float(interval.high)  # plain numbers, as JSON needs them
    return Figure(name, sum(known) / len(known), low, high, len(known), least, most)


def median(name: str, values: Iterable[float | None], least: float = -np.inf, most: float = np.inf) -> Figure:
    """The median with a distribution-free interval between two order statistics (David and Nagaraja, Order Statistics,
    2003, section 7.1); infinite for fewer than six values."""
    from scipy.stats import binom

    known = np.sort([value for value in values if value is not None]).astype(float)
    if not len(known):
        return Figure(name, None, -np.inf, np.inf, 0, least, most)
    left_out = int(binom.ppf(0.025, len(known), 0.5)) - 1  # number of values outside at either end
    low, high = (known[left_out], known[-1 - left_out]) if left_out >= 0 else (-np.inf, np.inf)
    return Figure(name, float(np.median(known)), float(low), float(high), len(known), least, most)


def figures(scores: Sequence[Score], seconds: float) -> list[Figure]:
    """The figures of a study; `seconds`: length of its recordings."""
    one, two, unlisted = (_of(scores, kind) for kind in ("one", "two", "unlisted"))
    complete = [score for score in scores if score.kind in NOTHING_MISSING]
    listed, missing = one + two, one + two + unlisted
    numbers = [number for score in listed for number in score.numbers]
    return [
        share("regime located, one effect", _each(one, lambda s: s.located), least=0.98),
        share("named right, one effect", _each(one, lambda s: s.named), least=0.97 if seconds >= LONG else 0.93),
        share("both of two effects named", _each(two, lambda s: s.named), least=0.85),
        share("truth in findings + also_possible", _each(listed, lambda s: s.within), least=0.99),
        median("size of that set for each true name", _each(listed, lambda s: s.set_size), most=1.5),
        share("false alarms where nothing is missing", _each(complete, lambda s: s.false_alarm), most=0.01),
        share("unlisted: flagged as such", _each(unlisted, lambda s: "unlisted" in s.said), least=0.95),
        share("unlisted: what it depends on", _each(unlisted, lambda s: s.depends_right), least=0.85),
        median("excess held-out error removed, listed", _each(listed, lambda s: s.excess_removed), least=0.95),
        median("excess held-out error removed, unlisted", _each(unlisted, lambda s: s.excess_removed), least=0.7),
        median("relative error of a parameter", [number.error for number in numbers], most=0.03),
        share("95 % intervals that hold the truth", [number.covered for number in numbers], 0.92, 0.98),
        share("nothing missing, no finding", _each(complete, lambda s: s.named)),
        share("something missing, undetermined", _each(missing, lambda s: s.verdict == "undetermined")),
        share("no diagnosis at all", _each(scores, lambda s: s.verdict == "failed"), most=0.0),
        median("seconds for a diagnosis", _each(scores, lambda s: s.seconds or None)),
    ]


def by_mechanism(scores: Sequence[Score]) -> list[Figure]:
    """The share of correct names for each mechanism and each unlisted law, among cases with one effect."""
    groups: dict[str, list[Score]] = {}
    for score in scores:
        if score.kind in ("one", "unlisted"):
            name = f"unlisted: {score.law}" if score.law else score.truth[0]
            groups.setdefault(name, []).append(score)
    return [share(name, _each(groups[name], lambda s: s.named)) for name in sorted(groups)]


def _of(scores: Sequence[Score], kind: str) -> list[Score]:
    return [score for score in scores if score.kind == kind]


def _each(scores: Sequence[Score], question: Callable[[Score], Any]) -> list[Any]:
    return [question(score) for score in scores]
