"""Laws that may be missing, each some columns of the design matrix, and models made of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine.normal_equations import NormalEquations
from sim2real.diagnose.engine.tuned import ENGINE


def no_parameters(theta: np.ndarray) -> Mapping[str, float]:
    """Return the simulator's parameters for a smooth term that it cannot represent: none."""
    return {}


@dataclass(frozen=True)
class Law:
    """Columns of the design matrix that enter or leave a model together.

    `name`: a mechanism of the simulator (a listed law), or a smooth term of the basis library (a family); `family` is
    what a smooth term depends on, "" for a listed law. `start`: parameters of a nonlinear law at which its columns were
    taken. `switch`: the simulator's parameters by name for coefficients (k,) of a smooth term. `mechanism`: what a
    finding calls a smooth term. `linear`: whether residuals are linear in its coefficients however large they are.
    `each_launch`: whether every launch has coefficients of its own, of which others say nothing. `searched`: how many
    places or sizes the columns are the best of. `variant_of`: a name that smooth terms share which differ in a size
    alone, and of which the best is taken.
    """

    name: str
    columns: tuple[str, ...]
    family: str = ""
    start: dict[str, float] = field(default_factory=dict)
    switch: Callable[[np.ndarray], Mapping[str, float]] = no_parameters
    linear: bool = False
    mechanism: str = "unlisted"
    each_launch: bool = False
    searched: int = 1
    variant_of: str = ""

    @property
    def rows(self) -> tuple[str, ...]:
        """The parameters that a nonlinear fit of a listed law frees: all of its effect's where a search found its
        `start`, such as a place, else those of its columns."""
        return EFFECTS[self.name].row_names if self.start else self.columns


@dataclass(frozen=True)
class Model:
    """The baseline's columns `base` and those of `laws` added to it; `spreads`: the prior standard deviation of each
    law's coefficients, which counts for smooth terms alone."""

    base: tuple[str, ...]
    laws: tuple[Law, ...] = ()
    spreads: tuple[float, ...] = ()

    def plus(self, law: Law, spread: float) -> Model:
        """The model with one more law."""
        return Model(self.base, (*self.laws, law), (*self.spreads, spread))

    def minus(self, law: Law) -> Model:
        """The model without one of its laws."""
        kept = [(one, spread) for one, spread in zip(self.laws, self.spreads, strict=True) if one is not law]
        return Model(self.base, tuple(one for one, _ in kept), tuple(spread for _, spread in kept))

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all columns, each once."""
        return tuple(dict.fromkeys((*self.base, *(name for law in self.laws for name in law.columns))))

    @property
    def key(self) -> tuple[Any, ...]:
        """A hashable identity."""
        return (self.base, tuple(law.columns for law in self.laws), self.spreads)

    def columns(self, equations: NormalEquations) -> tuple[np.ndarray, np.ndarray]:
        """Indices (k,) of all columns, and the ridge (k,) of each: 1 / spread² for a smooth term, a fixed one for a
        nonlinear law, whose coefficients are 1 where its columns were taken, and 0 for all other parameters."""
        names, ridge = list(self.base), [0.0] * len(self.base)
        for law, spread in zip(self.laws, self.spreads, strict=True):
            fresh = [name for name in law.columns if name not in names]
            names += fresh
            ridge += [1.0 / spread**2 if law.family else ENGINE.nonlinear_ridge if law.start else 0.0] * len(fresh)
        return equations.columns(names), np.array(ridge)
