"""A smooth law on top of a law of parameters, fitted about the path that the two together take."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import SPREADS, Chooser, Law, Model
from sim2real.diagnose.engine.fit import Fit
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

    Where the simulator can switch the family on, columns are taken anew about the path with it, until no step leads
    any further; else about the path without it.
    """
    here = _at(problem, law, family, np.zeros(len(family.columns)))
    best = _solved(problem, here, use, beyond)
    for _ in range(ROUNDS if family.switch(best.theta[len(law.free) :]) else 0):
        now = _loss(problem, here, use)
        there = _downhill(problem, here, best, use, now)
        if there is None:
            break
        here, best = there, _solved(problem, there, use, beyond)
        if now - _loss(problem, here, use) < ENOUGH * now:
            break
    return best


@dataclass(frozen=True)
class _Place:
    """Where columns were taken: at a law, with coefficients `at` of a family."""

    law: Fit
    family: Law
    at: np.ndarray
    columns: Columns


def _at(problem: Problem, law: Fit, family: Law, at: np.ndarray) -> _Place:
    values: Mapping[str, float] = {**law.values, **(family.switch(at) if at.any() else {})}
    columns = problem.columns(values, law.free, None)
    family = next(one for one in columns.families if one.name == family.name)
    moved = columns.grams.columns(family.columns)
    return _Place(law, family, at, replace(columns, grams=gram.moved(columns.grams, moved, -at)))


def _loss(problem: Problem, place: _Place, use: np.ndarray) -> float:
    """Soft loss of the law with the coefficients at which the columns were taken."""
    parts = problem.units.of(use)
    at = place.columns.grams.columns(place.family.columns)
    left = gram.losses(place.columns.grams, at, place.at, parts)
    return float(gram.soft(left, problem.units.freedom[parts]).sum())


def _solved(problem: Problem, place: _Place, use: np.ndarray, beyond: float) -> Smooth:
    """The least squares there, with the spread that foretells best."""
    chooser = Chooser(place.columns.grams, problem.units, use, beyond)
    models = [Model(place.law.free, (place.family,), (spread,)) for spread in SPREADS]
    foretold = [float(chooser.foretold(model).sum()) for model in models]
    best = int(np.argmin(foretold))
    index, ridge = models[best].columns(place.columns.grams)
    theta = gram.solve_softly(place.columns.grams, index, chooser.use, problem.units.freedom[chooser.use], ridge)
    return Smooth(place.law, place.family, SPREADS[best], place.columns, theta, foretold[best])


def _downhill(problem: Problem, here: _Place, step: Smooth, use: np.ndarray, now: float) -> _Place | None:
    """Where a step leads, or a part of it; None where all of them lead uphill."""
    n = len(here.law.free)
    for part in 0.5 ** np.arange(HALVINGS):
        values = dict(here.law.values)
        for name, change in zip(here.law.free, part * step.theta[:n], strict=True):
            values[name] = BY_NAME[name].within(values[name] + change)
        at = here.at + part * (step.theta[n:] - here.at)
        there = _at(problem, replace(here.law, values=values), here.family, at)
        if _loss(problem, there, use) < now:
            return there
    return None
