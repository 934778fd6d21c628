"""An account with what its report shows: where recording and simulator part, and each finding as a curve."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sim2real.diagnose.engine.explain import Explained
from sim2real.diagnose.finding import Account, Curve, Finding, Parting
from sim2real.diagnose.glide import picture as glides
from sim2real.diagnose.glide.problem import GlideProblem
from sim2real.diagnose.problem import Problem
from sim2real.diagnose.wall import picture as bounces
from sim2real.diagnose.wall.problem import WallProblem


def illustrated(problem: Problem, found: Explained, account: Account, use: np.ndarray) -> Account:
    """The account with its parting, and its findings with curves; `use`: the clusters that were fitted."""
    findings = tuple(replace(one, curve=_curve(problem, found, one)) for one in account.findings)
    return replace(account, findings=findings, parting=_parting(problem, found))


def _parting(problem: Problem, found: Explained) -> Parting:
    match problem:
        case GlideProblem():
            return glides.parting(problem, found)
        case WallProblem():
            return bounces.parting(problem, found)
    return _by_launch(problem, found)


def _curve(problem: Problem, found: Explained, one: Finding) -> Curve | None:
    picture = glides if isinstance(problem, GlideProblem) else bounces if isinstance(problem, WallProblem) else None
    if picture is None:
        return None
    if one.mechanism == "unlisted":
        assert found.unlisted is not None
        return picture.smooth_curve(problem, found, found.unlisted)
    return picture.listed_curve(problem, found, one.mechanism)


def _by_launch(problem: Problem, found: Explained) -> Parting:
    """The rms residual of each launch, for a regime of which nothing finer is drawn."""
    every = np.arange(problem.clusters)
    live = np.flatnonzero(problem.freedom > 0)
    sizes = []
    for values in (found.baseline.values, found.values):
        left = problem.residuals(values, (), every)
        squares = np.bincount(left.cluster, left.r**2, problem.clusters)[live]
        sizes.append(np.sqrt(squares / problem.freedom[live])[:, None])
    std = 1.0 / np.sqrt(2.0 * problem.freedom[live])[:, None]
    by = {"launch, in order of time": live.astype(float)}
    return Parting("rms residual", "units of the sensor's noise", ("rms",), sizes[0], sizes[1], std, by)
