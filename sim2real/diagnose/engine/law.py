"""What may be missing: columns of a problem's residuals that are named, fitted and judged together."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from puckpilot_env.physics.effects import EFFECTS


def no_parameters(theta: np.ndarray) -> Mapping[str, float]:
    """The simulator's parameters for a family that it has no place for."""
    return {}


@dataclass(frozen=True)
class Law:
    """Columns of a problem's residuals that stand or fall together.

    `name`: a mechanism, or a family of smooth forces; `family` is what it depends on, "" for a mechanism. `start`:
    parameters of a nonlinear law at which its columns were taken. `switch`: the simulator's parameters by name for
    coefficients of a family; none where the simulator has no place for it. `mechanism`: what a finding calls a family.
    `straight`: whether columns taken without a family hold with it too, however large it is. `each_launch`: whether
    every launch has numbers of its own, which no other launch foretells; `searched`: how many places or sizes the
    columns are the best of; `among`: what families are called that differ in a size alone, and of which the best is
    taken.
    """

    name: str
    columns: tuple[str, ...]
    family: str = ""
    start: dict[str, float] = field(default_factory=dict)
    switch: Callable[[np.ndarray], Mapping[str, float]] = no_parameters
    straight: bool = False
    mechanism: str = "unlisted"
    each_launch: bool = False
    searched: int = 1
    among: str = ""

    @property
    def rows(self) -> tuple[str, ...]:
        """The parameters that a nonlinear fit of a mechanism frees: where it had to be looked for, such as a place,
        all of its effect's, else those whose columns it has."""
        return EFFECTS[self.name].row_names if self.start else self.columns
