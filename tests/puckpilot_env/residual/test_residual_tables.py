"""Tables with corrections: none changes nothing, others act where play goes on and break nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from puckpilot_env import Tables
from puckpilot_env.checks.adversarial import invariants
from puckpilot_env.residual.network import INPUTS, Residual, no_residual
from puckpilot_env.residual.tables import ResidualTables
from tests.puckpilot_env.batch.batches import actions_for, assert_same, outputs
from tests.puckpilot_env.game.hand import LENGTH, PUCK, put_mallet, put_puck, seen, staying


def always(correction: Sequence[float]) -> Residual:
    """A network that gives the same correction whatever it sees."""
    numbers = np.array(correction, np.float32)
    return replace(no_residual(), middle=numbers, bound=np.abs(numbers))


@pytest.mark.parametrize("threads", [1, 3])
def test_a_correction_of_nothing_leaves_the_tables_as_they_are(threads: int) -> None:
    plain = Tables("match-v0", 40, seed=3)
    corrected = ResidualTables("match-v0", 40, no_residual(), seed=3, threads=threads)
    for actions in actions_for(plain, 150):
        plain.step(actions)
        corrected.step(actions)
        assert_same(outputs(plain), outputs(corrected))
    corrected.close()


@pytest.mark.parametrize("age", [0.0, 0.02])
def test_a_puck_in_the_open_is_corrected_and_both_players_see_it(age: float) -> None:
    late = {"observation_age": age}
    tables = ResidualTables("match-v0", 3, always([0.02, -0.01, 0.3, 0.1]), seed=0, parameters=late)
    plain = Tables("match-v0", 3, seed=0, parameters=late)
    for one in (tables, plain):
        put_mallet(one, 0, 0.2, 0.5)
        put_mallet(one, 1, 0.2, 0.5)
        put_puck(one, np.array([0.6, 0.9, 1.91]), 0.2, 0.5, 0.2)
        one.step(staying(one))
    was, now = plain.states["puck"], tables.states["puck"]
    assert now["x"][:2] - was["x"][:2] == pytest.approx([0.02, 0.02])
    assert now["x"][2] == pytest.approx(LENGTH - PUCK)  # no farther than the wall
    for name, change in (("y", -0.01), ("vx", 0.3), ("vy", 0.1)):
        assert now[name] - was[name] == pytest.approx(np.full(3, change))
    assert seen(tables, 0, "puck_x") == pytest.approx(now["x"], abs=1e-4)
    assert seen(tables, 1, "puck_vx") == pytest.approx(-now["vx"], abs=1e-4)
    assert (seen(tables, 0, "expected_0.5s_x")[:2] > seen(plain, 0, "expected_0.5s_x")[:2]).all()


@pytest.mark.parametrize("correction", [(0.3, 0.2, 4.0, -3.0), (-0.4, -0.3, -9.0, 5.0)])
def test_wild_corrections_break_nothing_and_leave_what_was_just_put_there(correction: tuple[float, ...]) -> None:
    """Each step is held against a plain one from the same state."""
    tables = ResidualTables("match-v0", 60, always(correction), seed=1, max_cycles=60, parameters={"hand": 1.0})
    plain = Tables("match-v0", 60, seed=1, max_cycles=60, parameters={"hand": 1.0})
    served, moved = 0, 0
    for actions in actions_for(tables, 200):
        plain.restore(tables.snapshot())
        plain.step(actions)
        tables.step(actions)
        put = plain.states["held"] == 0.0
        served += put.sum()
        alone = put | ~tables.went_on
        assert_same(outputs(plain, alone), outputs(tables, alone))
        was, now = plain.states["puck"], tables.states["puck"]
        moved += (was["x"] != now["x"]).sum()
        assert (np.sign(was["x"] - LENGTH / 2) == np.sign(now["x"] - LENGTH / 2)).all()
        assert (plain.rewards == tables.rewards).all() and (plain.states["score"] == tables.states["score"]).all()
        assert not invariants.not_finite(tables).any()
        assert invariants.depth_outside(tables).max() < invariants.DEEPEST_OUTSIDE
        deep = invariants.depth_in_mallets(tables)[~alone]
        assert deep.max(initial=0.0) < invariants.DEEPEST_IN_MALLET
    assert served > 60 and moved > 2000 and ((tables.states["episode"]) > 3).all()


def test_where_the_opponent_strikes_nothing_is_corrected() -> None:
    tables = ResidualTables("match-v0", 2, always([0.0, 0.0, 1.0, 0.0]), seed=0)
    put_mallet(tables, 0, 0.2, 0.5)
    put_mallet(tables, 1, 1.5, 0.5, seen_by=0)
    put_puck(tables, np.array([1.3, 0.7]), 0.5, 3.0, 0.0)  # the first reaches the mallet
    tables.step(staying(tables))
    assert tables.went_on.tolist() == [False, True] and tables.states["puck"]["vx"][0] < 0.0


def test_a_turned_table_is_corrected_in_the_robot_s_frame() -> None:
    rng = np.random.default_rng(2)
    tilted = replace(
        always([0.01, 0.01, 0.3, 0.3]), weights=[rng.normal(size=(4, len(INPUTS))).astype(np.float32)],
        scale=np.array([1e-3, 1e-3, 1e-2, 1e-2], np.float32),
    )  # fmt: skip
    one, other = (ResidualTables("match-v0", 20, tilted, seed=4) for _ in range(2))
    for actions in actions_for(one, 8):
        one.step(actions)
        other.turn()
        other.step(actions[:, ::-1])
        other.turn()
        assert (one.went_on == other.went_on).all()
        for name in ("x", "y", "vx", "vy"):
            assert other.states["puck"][name] == pytest.approx(one.states["puck"][name], abs=1e-4)


@pytest.mark.parametrize(("variant", "options"), [("match-sensors-v0", {}), ("match-v0", {"period": 0.05})])
def test_tables_that_no_network_is_fitted_to_are_refused(variant: str, options: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=rf"cannot correct puckpilot/{variant} with steps of .*expected .*0\.1 s"):
        ResidualTables(variant, 2, no_residual(), **options)
