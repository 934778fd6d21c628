"""A smooth law on top of a law of parameters, fitted about the path that the two together take."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import SPREADS, Chooser, Model
from sim2real.diagnose.engine.fit import Fit
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.problem import Columns, Problem

ROUNDS = 8  # of Gauss-Newton, at most
ENOUGH = 0.002  # of the loss, a drop by which ends the rounds
HALVINGS = 4  # of a step that leads uphill


@dataclass(frozen=True)
class Smooth:
    """A family fitted on top of `law`. `theta` (n + k,): steps of the law's numbers, and the family's coefficients, in
    `columns`, which stand for the whole family, wherever they were taken. `foretold`: held-out loss."""

    law: Fit
    family: Law
    spread: float
    columns: Columns
    theta: np.ndarray
    foretold: float

    @property
    def model(self) -> Model:
        """The law's numbers and the family."""
        return Model(self.law.free, (self.family,), (self.spread,))

    def covariance(self, problem: Problem, use: np.ndarray) -> np.ndarray:
        """Of `theta` (n + k, n + k), from the clusters `use` that it was fitted to."""
        launches = gram.gathered(self.columns.grams, problem.units.cluster, problem.clusters)
        return gram.covariance(launches, self.model.columns(self.columns.grams)[0], self.theta, use)


def fit_smooth(problem: Problem, law: Fit, family: Law, use: np.ndarray, beyond: float) -> Smooth:
    """Fit `family` on top of `law` to the clusters `use`; `beyond`: noise beyond the problem's, in variance.

    Where the simulator can switch on a family that is not straight, columns are taken anew about the path with it,
    until no step leads any further; else about the path without it. A family of which every step leads uphill foretells
    nothing.
    """
    search = _Search(problem, use, beyond)
    here = search.at(law, family, np.zeros(len(family.columns)))
    best = search.solved(here)
    if family.straight or not family.switch(best.theta[len(law.free) :]):
        return best
    foretold = np.inf
    for _ in range(ROUNDS):
        there = search.downhill(here, best)
        if there is None:
            return replace(best, theta=np.concatenate([np.zeros(len(law.free)), here.at]), foretold=foretold)
        foretold, now = best.foretold, search.loss(here, best.spread)
        here, best = there, search.solved(there)
        if now - search.loss(here, best.spread) < ENOUGH * now:
            break
    return best


@dataclass(frozen=True)
class _Place:
    """Where columns were taken: at a law, with coefficients `at` of a family."""

    law: Fit
    family: Law
    at: np.ndarray
    columns: Columns


class _Search:
    """Steps of Gauss-Newton on the clusters `use`."""

    def __init__(self, problem: Problem, use: np.ndarray, beyond: float) -> None:
        self._problem, self._use, self._beyond = problem, use, beyond
        self._parts = problem.units.of(use)
        self._freedom = problem.units.freedom[self._parts] * beyond

    def at(self, law: Fit, family: Law, at: np.ndarray) -> _Place:
        """A place, with the columns about its path."""
        values: Mapping[str, float] = {**law.values, **(family.switch(at) if at.any() else {})}
        columns = self._problem.columns(values, law.free, None)
        family = next(one for one in columns.families if one.name == family.name)
        moved = columns.grams.columns(family.columns)
        return _Place(law, family, at, replace(columns, grams=gram.moved(columns.grams, moved, -at)))

    def loss(self, place: _Place, spread: float) -> float:
        """Soft loss at a place, and what its coefficients cost by their spread."""
        columns = place.columns.grams.columns(place.family.columns)
        left = gram.losses(place.columns.grams, columns, place.at, self._parts)
        return float(gram.soft(left, self._freedom).sum() + np.sum(place.at**2) / spread**2)

    def solved(self, place: _Place) -> Smooth:
        """The least squares there, with the spread that foretells best."""
        grams = place.columns.grams
        chooser = Chooser(grams, self._problem.units, self._use, self._beyond)
        models = [Model(place.law.free, (place.family,), (spread,)) for spread in SPREADS]
        foretold = [float(chooser.foretold(model).sum()) for model in models]
        best = int(np.argmin(foretold))
        index, ridge = models[best].columns(grams)
        theta = gram.solve_softly(grams, index, self._parts, self._freedom, ridge)
        return Smooth(place.law, place.family, SPREADS[best], place.columns, theta, foretold[best])

    def downhill(self, here: _Place, step: Smooth) -> _Place | None:
        """Where a step leads, or a part of it; None where all of them lead uphill."""
        n = len(here.law.free)
        now = self.loss(here, step.spread)
        for part in 0.5 ** np.arange(HALVINGS):
            values = dict(here.law.values)
            for name, change in zip(here.law.free, part * step.theta[:n], strict=True):
                values[name] = BY_NAME[name].within(values[name] + change)
            at = here.at + part * (step.theta[n:] - here.at)
            there = self.at(replace(here.law, values=values), here.family, at)
            if self.loss(there, step.spread) < now:
                return there
        return None
