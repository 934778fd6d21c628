"""Two places at once are those that a mallet has at either time, whatever of its plan lies between them."""

from __future__ import annotations

import numpy as np
import pytest

from puckpilot_env import Tables
from puckpilot_env.game.step import plan_both
from puckpilot_env.physics.gantry.mallet import halt, place_at
from puckpilot_env.physics.gantry.places import places_at_both

COUNT = 300


@pytest.fixture(scope="module")
def planned() -> Tables:
    """Tables in play whose mallets have just been given plans of all kinds."""
    tables = Tables("match-randomized-v0", COUNT, seed=4)
    rng = np.random.default_rng(4)
    low, high = tables.action_bounds
    for _ in range(5):
        actions = np.clip(rng.uniform(low, high, (COUNT, 2, 4)).astype(np.float32), low, high)
        tables.step(actions)
    for table, p, row in zip(tables.states, tables.params, actions, strict=True):
        plan_both(table, p, tables.nominal[0], row, np.zeros(2, np.float32))
    return tables


@pytest.mark.parametrize("stalled", [False, True])
@pytest.mark.parametrize("lag", [0.0, 1 / 60, 0.3])
@pytest.mark.parametrize("t", [0.0, 0.002, 0.07, 0.4])
def test_both_places(planned, t, lag, stalled):
    for table in planned.states.copy():
        for mallet in table["mallets"]:
            if stalled:
                halt(mallet, t + 0.01)
            both = places_at_both(mallet, t, t + lag)
            np.testing.assert_allclose(both, (*place_at(mallet, t), *place_at(mallet, t + lag)), rtol=0, atol=2e-14)
