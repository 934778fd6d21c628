"""Wall contacts that scatter by more than the sensor noise: the estimated scatter and the selected law."""

from __future__ import annotations

import numpy as np
import pytest

from puckpilot_env.parameters import TABLE
from puckpilot_env.physics.contacts import bounce
from sim2real.diagnose.regimes.wall.data import WallContacts
from sim2real.diagnose.regimes.wall.problem import WallProblem
from sim2real.diagnose.regimes.wall.scatter import search_wall_model

COUNT, LAUNCHES, NOISE = 120, 24, 0.001
ASSUMED = {"wall_restitution": 0.7}
DEFAULTS = {row.name: row.default for row in TABLE}


def rough_wall(restitution, scatter: tuple[float, float], wrong: int = 0) -> WallProblem:
    """Contacts with the wall y0 that keep `restitution`, a function of the closing speed, of both components, plus a
    random share `scatter` of the closing speed; `wrong` of them lose nearly all of it."""
    rng = np.random.default_rng(3)
    closing, along = rng.uniform(0.4, 4.0, COUNT), rng.uniform(-2.0, 2.0, COUNT)
    off = rng.normal(size=(2, COUNT)) * np.array(scatter)[:, None] * closing + rng.normal(0.0, NOISE, (2, COUNT))
    kept = restitution(closing)
    before = np.stack([along, -closing], axis=1)
    after = np.stack([kept * along + off[1], kept * closing + off[0]], axis=1)
    if wrong:
        after[rng.choice(COUNT, wrong, replace=False)] *= [1.0, 0.05]
    up = np.tile([0.0, 1.0], (COUNT, 1))
    spread = np.tile(0.5 * NOISE**2 * np.eye(2), (COUNT, 2, 1, 1))
    t = np.arange(COUNT, dtype=float)
    data = WallContacts(
        kind=np.full(COUNT, bounce.WALL_Y0), normal=up, t=t, velocity_before=before, velocity_after=after,
        velocity_covariance=spread,
        place=np.stack([rng.uniform(0.2, 1.8, COUNT), np.full(COUNT, 0.03)], axis=1),
        common_errors=np.zeros((COUNT, 2, 2, 0)), normal_std=np.zeros(COUNT), spin_chain=np.arange(COUNT),
        spin_unknown=np.ones(COUNT, bool), time_since_contact=np.full(COUNT, np.nan),
        cluster=np.arange(COUNT) * LAUNCHES // COUNT,
    )  # fmt: skip
    return WallProblem(data, LAUNCHES, DEFAULTS)


def test_an_ideal_wall_has_no_scatter() -> None:
    ideal = rough_wall(lambda closing: 0.8 + 0.0 * closing, (0.0, 0.0))
    problem, found = search_wall_model(ideal, ASSUMED, np.arange(LAUNCHES), True)
    assert problem is ideal and not found.listed and found.unlisted is None


@pytest.mark.slow
@pytest.mark.parametrize("wrong", [pytest.param(0, marks=pytest.mark.long), 15])
def test_scatter_alone_is_no_law(wrong: int) -> None:
    rough = rough_wall(lambda closing: 0.8 + 0.0 * closing, (0.02, 0.05), wrong)
    problem, found = search_wall_model(rough, ASSUMED, np.arange(LAUNCHES), True)
    assert not problem.scatter.any()
    assert not found.listed and found.unlisted is None


@pytest.mark.slow
def test_a_fall_with_speed_is_named_in_spite_of_scatter() -> None:
    rough = rough_wall(lambda closing: 0.88 - 0.03 * closing, (0.02, 0.05), 10)
    _, found = search_wall_model(rough, ASSUMED, np.arange(LAUNCHES), True)
    assert [law.name for law in found.listed] == ["speed_dependent_restitution"]
    assert found.law.values["restitution_slope"] == pytest.approx(0.03, abs=0.006)
