"""Batches saved, put back and forked: what follows is what would have been."""

from __future__ import annotations

import numpy as np
import pytest

from puckpilot_env import Tables
from tests.puckpilot_env.batches import SHORT, actions_for, assert_same, outputs


@pytest.mark.parametrize("variant", SHORT)
def test_restore_plays_the_same_again(variant):
    """Through automatic resets, random streams and drawn parameters included."""
    tables = Tables(variant, 16, seed=1, max_cycles=12)
    script = actions_for(tables, 45)
    for actions in script[:10]:
        tables.step(actions)
    saved = tables.snapshot()
    first = []
    for actions in script[10:]:
        tables.step(actions)
        first.append(outputs(tables))
    tables.reset(77)
    tables.restore(saved)
    assert tables.observations.tobytes() == saved.observations.tobytes()
    for actions, before in zip(script[10:], first, strict=True):
        tables.step(actions)
        assert_same(before, outputs(tables))


@pytest.mark.parametrize("variant", SHORT)
def test_restoring_one_leaves_the_others(variant):
    tables = Tables(variant, 4, seed=1, max_cycles=12)
    script = actions_for(tables, 30)
    saved = tables.snapshot([2])
    for actions in script[:13]:
        tables.step(actions)
    others = tables.snapshot([0, 1, 3])
    tables.restore(saved, [2])
    assert tables.snapshot([2]).states.tobytes() == saved.states.tobytes()
    kept = tables.snapshot([0, 1, 3])
    for name in ("states", "params", "frames", "observations"):
        assert getattr(kept, name).tobytes() == getattr(others, name).tobytes()


@pytest.mark.parametrize("variant", SHORT)
def test_fork(variant):
    """All tables become one, and stay alike under alike actions; under others they part."""
    tables = Tables(variant, 8, seed=1, max_cycles=12)
    script = actions_for(tables, 30)
    for actions in script[:5]:
        tables.step(actions)
    tables.restore(tables.snapshot([3]))
    for actions in script[5:]:
        tables.step(np.broadcast_to(actions[:1], actions.shape))
        for i in range(1, 8):
            assert_same(outputs(tables, [0]), outputs(tables, [i]))
    tables.step(script[0])
    assert len({row.tobytes() for row in tables.observations}) == 8


def test_restore_refuses_what_does_not_fit():
    match, drill = Tables("match-v0", 2), Tables("defence-v0", 2)
    with pytest.raises(ValueError, match="another variant or camera"):
        match.restore(drill.snapshot())
    with pytest.raises(ValueError, match="snapshot has 2 tables; expected 1 or 3"):
        Tables("match-v0", 3).restore(match.snapshot())
