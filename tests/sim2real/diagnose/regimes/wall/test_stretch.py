"""A stretch of one wall is found where it is, and its name makes it again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from puckpilot_env.parameters import TABLE
from sim2real.diagnose.regimes.wall.data import KINDS, place_along_wall
from sim2real.diagnose.regimes.wall.problem import WallProblem
from sim2real.diagnose.regimes.wall.stretch import Stretch, find_stretches, stretch_named
from tests.sim2real.diagnose.regimes.wall.test_as_effect import random_contacts

BASE = {"wall_restitution": 0.7}


def problem_of(softer: Stretch | None) -> WallProblem:
    """Contacts of which those in a stretch keep a fifth less of either speed; noise of 0.5 mm/s."""
    data = random_contacts(150)
    data = replace(data, kind=np.where(data.kind == 5, KINDS["y0"], data.kind))
    common = {row.name: row.default for row in TABLE}
    predicted = WallProblem(data, 1, common).predicted(BASE)[:, :2]
    if softer is not None:
        predicted = predicted - 0.2 * data.approach[:, :2] * softer.inside(data)
    tangent = np.stack([-data.normal[:, 1], data.normal[:, 0]], axis=1)
    after = predicted[:, :1] * data.normal + predicted[:, 1:] * tangent
    noise = np.random.default_rng(1).normal(0.0, 0.5e-3, after.shape)
    return WallProblem(replace(data, velocity_after=after + noise), 1, common)


def found_in(problem: WallProblem) -> list[Stretch]:
    exact = problem.residuals(BASE, problem.base, np.arange(1))
    return find_stretches(problem, BASE, exact, len(problem.base), np.arange(1))[0]


@pytest.mark.parametrize("true", [Stretch("y1", 0.5, 1.1), Stretch("y0", 1.2, 1.7), Stretch("x1", 0.05, 0.14)])
def test_it_is_found_where_it_is(true: Stretch) -> None:
    problem = problem_of(true)
    s = place_along_wall(problem.data)
    inside = [set(np.flatnonzero(one.inside(problem.data)[:, 0])) for one in found_in(problem)]
    wanted = set(np.flatnonzero(true.inside(problem.data)[:, 0]))
    assert len(wanted) > 3
    assert min(len(one ^ wanted) for one in inside) <= 2, (s[sorted(wanted)], found_in(problem))


def test_where_nothing_is_softer_none_is_offered() -> None:
    assert found_in(problem_of(None)) == []


def test_a_name_makes_it_again_and_no_other_does() -> None:
    assert stretch_named(Stretch("x0", 0.125, 0.5).name) == Stretch("x0", 0.125, 0.5)
    assert stretch_named("place") is None and stretch_named("a stretch of z0 from 0.1 m to 0.2 m") is None
