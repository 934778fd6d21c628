"""What a physical number is, and what an effect is: a piece of physics beyond the baseline, in one file of its own.

An effect's file in `physics/effects/` is read by the simulator (its kernels), by the table of parameters (its rows), by
the randomization, and by the diagnosis (regime, bounds, what excites it).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Parameter:
    """One physical number. `low` and `high` bound what the simulator accepts, of a `whole` one whole numbers alone;
    `default` is what a table has."""

    name: str
    unit: str
    default: float
    low: float
    high: float
    meaning: str
    source: str
    whole: bool = False

    def within(self, value: float) -> float:
        """The nearest value that the simulator accepts."""
        return float(min(max(value, self.low), self.high))


def _nothing(numbers: Mapping[str, float]) -> str:
    """A misfit that no numbers have."""
    return ""


def falling(knots: Sequence[float]) -> str:
    """The misfit of knots that fall; "" if they do not."""
    down = next((k for k in range(1, len(knots)) if knots[k] < knots[k - 1]), None)
    if down is None:
        return ""
    return f"knot {down} is {knots[down]:g} after {knots[down - 1]:g}; expected knots that do not fall"


@dataclass(frozen=True)
class Effect:
    """Physics that a table may have beyond the baseline. It is off while all its rows are at their defaults.

    `regime`: glide, wall, corner, mallet, gantry or sensing. `law`: the formula, in words that a report can print.
    `rows`: the parameters, keyed by the short names that a diagnosis gives them. `depends_on`: what the force or the
    impulse depends on (position, speed, heading, time, history, command). `excited_by`: the recording that shows it.
    `listed`: whether it is one mechanism with a name, and not a table of numbers that may hold any.
    `not_simulated`: why no table can be given it, "" if it can; the diagnosis alone knows such an effect.
    `misfit`: what keeps numbers of a table of them, by their short names, from being a law that can be simulated; ""
    if nothing does.
    """

    regime: str
    law: str
    rows: Mapping[str, Parameter]
    depends_on: tuple[str, ...]
    excited_by: str
    source: str
    listed: bool = True
    not_simulated: str = ""
    misfit: Callable[[Mapping[str, float]], str] = _nothing

    @property
    def row_names(self) -> tuple[str, ...]:
        """The parameters by the names that the simulator gives them."""
        return tuple(row.name for row in self.rows.values())
