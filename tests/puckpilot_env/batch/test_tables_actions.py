"""Actions of batches: what is bad is refused and changes nothing, what rounding took out of the space is played."""

from __future__ import annotations

import numpy as np
import pytest

from puckpilot_env import Tables
from tests.puckpilot_env.batch.batches import actions_for, assert_same, outputs

HIGHEST = np.finfo(np.float32).max


@pytest.mark.parametrize(
    "column, number, expected",
    [
        (0, np.nan, "action target_x of player_1 on table 2 is nan; expected a number in [0.0505, 0.9495] m"),
        (1, np.inf, "action target_y of player_1 on table 2 is inf; expected a number in [0.0505, 0.9495] m"),
        (2, 10.00001, "action volts_x of player_1 on table 2 is 10.00001; expected a number in [0.3, 10] V"),
        (3, -HIGHEST, "action volts_y of player_1 on table 2 is -3.4028235e+38; expected a number in [0.3, 10] V"),
    ],
)
@pytest.mark.parametrize("variant", ["match-randomized-v0", "defence-v0"])
def test_bad_actions_change_nothing(variant, column, number, expected):
    tables = Tables(variant, 4, seed=1)
    script = actions_for(tables, 4)
    for actions in script:
        tables.step(actions)
    before, frames = outputs(tables), tables.snapshot().frames
    script[-1, 2, 1, column] = number
    with pytest.raises(ValueError) as refusal:
        tables.step(script[-1])
    assert str(refusal.value) == expected
    assert_same(before, outputs(tables))
    assert frames.tobytes() == tables.snapshot().frames.tobytes()


@pytest.mark.parametrize("side", [0, 1])
def test_actions_that_rounding_took_out_of_the_space_are_played_at_its_edge(side):
    """As gymnasium's RescaleAction makes them, in float32."""
    edge, beyond = (Tables("match-v0", 1, seed=2) for _ in range(2))
    actions = np.broadcast_to(edge.action_bounds[side], (1, 2, 4)).astype(np.float32)
    off = np.nextafter(actions, np.float32(-1e9 if side == 0 else 1e9))
    assert not np.array_equal(actions, off)
    for _ in range(5):
        edge.step(actions)
        beyond.step(off)
    np.testing.assert_allclose(beyond.observations, edge.observations, atol=1e-5)


@pytest.mark.parametrize("shape", [(4, 2), (4, 2, 3), (3, 2, 4), (2, 4, 4), (32,), ()])
def test_wrong_shapes_change_nothing(shape):
    tables = Tables("match-v0", 4, seed=1)
    before = outputs(tables)
    with pytest.raises(ValueError, match="expected") as refusal:
        tables.step(np.full(shape, 0.5, np.float32))
    assert str(refusal.value) == f"actions have shape {shape or (1,)}; expected (4, 2, 4)"
    assert_same(before, outputs(tables))
