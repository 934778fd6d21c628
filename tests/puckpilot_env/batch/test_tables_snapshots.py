"""Batches saved, put back and forked: what follows is what would have been."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from puckpilot_env import Tables, find_variant
from puckpilot_env.options.randomization import Draw
from tests.puckpilot_env.batch.batches import SHORT, actions_for, assert_same, outputs


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


@pytest.mark.parametrize(
    "name, value",
    [("length", 2.4), ("width", 1.1), ("goal_width", 0.3), ("puck_radius", 0.03), ("mallet_radius", 0.05)],
)
def test_a_snapshot_of_tables_of_another_size_is_refused_and_changes_nothing(name, value):
    other = Tables("match-randomized-v0", 2, seed=1, parameters={name: value})
    tables = Tables("match-randomized-v0", 2, seed=2)
    before = tables.snapshot()
    expected = (
        rf"^the snapshot is of tables of {name} {value:g} m; expected {tables.nominal[name][0]:g} m, as these have$"
    )
    with pytest.raises(ValueError, match=expected):
        tables.restore(other.snapshot())
    after = tables.snapshot()
    assert all(
        getattr(before, one).tobytes() == getattr(after, one).tobytes() for one in ("states", "params", "frames")
    )


def test_other_numbers_are_restored_with_the_tables():
    slick, plain = Tables("match-v0", 2, seed=1, parameters={"friction": 0.01}), Tables("match-v0", 2, seed=2)
    plain.restore(slick.snapshot([1]), [0])
    assert plain.params["friction"].tolist() == [0.01, 0.125]
    script = actions_for(slick, 20)
    for actions in script:
        slick.step(actions[::-1])
        plain.step(actions)
        assert plain.states[:1].tobytes() == slick.states[1:].tobytes()


def test_tables_that_draw_their_length_take_what_they_may_draw():
    """The nominal length is the same; the drawn ones differ, and need not be those of the taking tables."""

    def drawing(low, high):
        draws = (Draw("length", "uniform", low, high, ""),)
        return Tables(replace(find_variant("match-v0"), draws=draws), 3, seed=1)

    narrow, wide, plain = drawing(1.99, 2.01), drawing(1.95, 2.05), Tables("match-v0", 3)
    assert len(set(narrow.params["length"].tolist())) == 3
    wide.restore(narrow.snapshot())
    assert wide.params["length"].tobytes() == narrow.params["length"].tobytes()
    wide.restore(plain.snapshot())
    wide.params["length"] = [2.0, 2.05, 1.95]
    with pytest.raises(
        ValueError, match=r"has a table of length 2\.05 m; expected 1\.99 to 2\.01 m, as these tables draw it"
    ):
        narrow.restore(wide.snapshot())
    with pytest.raises(ValueError, match=r"has a table of length 2\.05 m; expected 2 m, as these tables have"):
        plain.restore(wide.snapshot())
    plain.restore(wide.snapshot([0]))


def test_orders_later_than_a_period_are_not_restored():
    late = Tables("match-v0", 1, parameters={"command_delay": 0.06})
    quick = Tables("match-v0", 1, period=0.05)
    with pytest.raises(ValueError, match=r"command_delay of 0.06 s; expected less than the period, 0.05 s"):
        quick.restore(late.snapshot())


@pytest.mark.parametrize(
    "index, expected",
    [
        ([3], "tables is [3]; expected a slice, a mask or indices of 3 tables"),
        (-4, "tables is -4; expected a slice, a mask or indices of 3 tables"),
        ([0.0], "tables is [0.0]; expected a slice, a mask or indices of 3 tables"),
        ("all", "tables is 'all'; expected a slice"),
        (None, "tables is None; expected a slice"),
        ([[0, 1]], "tables is [[0, 1]]; expected a slice"),
        ([[0], [0, 1]], "tables is [[0], [0, 1]]; expected a slice"),
        ([True, False], "tables is [True, False]; expected a slice, a mask"),
        ([1, -2], "tables is [1, -2]; expected each table once"),
        (slice("a"), "tables is slice(None, 'a', None); expected a slice of whole numbers"),
        (slice(0, 2, 0), "tables is slice(0, 2, 0); expected a slice of whole numbers"),
    ],
)
def test_an_index_of_no_table_is_refused(index, expected):
    tables = Tables("match-v0", 3)
    for call in (lambda: tables.snapshot(index), lambda: tables.restore(tables.snapshot([0]), index)):
        with pytest.raises(ValueError, match=f"^{re.escape(expected)}"):
            call()


@pytest.mark.parametrize(
    "index, same",
    [
        (2, [2]), (-1, [2]), (np.int8(1), [1]), ((0, 2), [0, 2]), ([], []), ([False, True, True], [1, 2]),
        (slice(None, None, -1), [2, 1, 0]), (np.array([2, 0], np.uint8), [2, 0]),
    ],
)  # fmt: skip
def test_tables_may_be_named_in_several_ways(index, same):
    tables = Tables("match-v0", 3, seed=1)
    saved = tables.snapshot(index)
    assert saved.states.tobytes() == b"".join(tables.states[i].tobytes() for i in same)
    tables.reset(2)
    tables.restore(saved, index)
    assert tables.states[same].tobytes() == saved.states.tobytes()


@pytest.mark.parametrize("given", [None, 3, {}, "a", Tables])
def test_what_is_no_snapshot_is_refused(given):
    with pytest.raises(ValueError, match=r"^snapshot is .*; expected what Tables.snapshot\(\) gives$"):
        Tables("match-v0", 1).restore(given)


def test_a_snapshot_of_another_version_is_refused():
    tables = Tables("match-v0", 1)
    saved = tables.snapshot()
    with pytest.raises(ValueError, match="the snapshot's states are of another version of the simulator"):
        tables.restore(replace(saved, states=saved.states[["score", "steps"]]))


def test_restore_refuses_what_does_not_fit():
    match, drill = Tables("match-v0", 2), Tables("defence-v0", 2)
    with pytest.raises(ValueError, match="another variant or camera"):
        match.restore(drill.snapshot())
    with pytest.raises(ValueError, match="snapshot has 2 tables; expected 1 or 3"):
        Tables("match-v0", 3).restore(match.snapshot())
