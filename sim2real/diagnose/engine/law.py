"""Laws that may be missing, each a set of columns of the design matrix, and models composed of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine.linear.normal_equations import NormalEquations
from sim2real.diagnose.engine.tuned import ENGINE


def no_parameters(theta: np.ndarray) -> Mapping[str, float]:
    """Return the simulator's parameters for a smooth term that it cannot represent: none."""
    return {}


@dataclass(frozen=True)
class Law:
    """Columns of the design matrix that enter or leave a model together.

    `name`: a mechanism of the simulator (a listed law), or a smooth term of the basis library (a family); `family`: the
    quantity on which a smooth term depends, "" for a listed law. `start`: parameters of a nonlinear law at which its
    columns were linearized. `switch`: maps coefficients (k,) of a smooth term to the simulator's parameters by name.
    `mechanism`: the name of a smooth term in a finding. `linear`: whether residuals are linear in its coefficients at
    any size. `each_launch`: whether each launch has coefficients of its own. `searched`: number of places or sizes from
    which the columns were chosen. `variant_of`: common name of smooth terms that differ only in a size; the best of
    them is used.
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
    def is_simple(self) -> bool:
        """Whether a smooth term has a place or size of its own and no more than two coefficients: as few numbers as a
        listed law, which cannot approximate any other."""
        return self.searched > 1 and len(self.columns) <= 2

    @property
    def rows(self) -> tuple[str, ...]:
        """The free parameters of a listed law in a nonlinear fit.

        They are all parameters of its effect if it has a `start`, else those of its columns.
        """
        return EFFECTS[self.name].row_names if self.start else self.columns


@dataclass(frozen=True)
class Model:
    """The baseline's columns `base` and added `laws`; `spreads`: prior standard deviation of each law's coefficients,
    used for smooth terms alone."""

    base: tuple[str, ...]
    laws: tuple[Law, ...] = ()
    spreads: tuple[float, ...] = ()

    def plus(self, law: Law, spread: float) -> Model:
        """Return the model with one more law."""
        return Model(self.base, (*self.laws, law), (*self.spreads, spread))

    def minus(self, law: Law) -> Model:
        """Return the model without one of its laws."""
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
        """Return the indices (k,) of all columns and the ridge (k,) of each.

        The ridge is 1 / spread² for a smooth term, fixed for a nonlinear law, whose coefficients are 1 at its start,
        and 0 for all other parameters.
        """
        names, ridge = list(self.base), [0.0] * len(self.base)
        for law, spread in zip(self.laws, self.spreads, strict=True):
            fresh = [name for name in law.columns if name not in names]
            names += fresh
            ridge += [1.0 / spread**2 if law.family else ENGINE.nonlinear_ridge if law.start else 0.0] * len(fresh)
        return equations.columns(names), np.array(ridge)
