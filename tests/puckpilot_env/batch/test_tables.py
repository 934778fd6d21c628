"""Batches: a table plays the same in any company, on any number of threads, and in steps of any length."""

from __future__ import annotations

import numpy as np
import pytest

from puckpilot_env import Tables, find_variant
from puckpilot_env.batch import kernels
from tests.puckpilot_env.batch.batches import SHORT, actions_for, assert_same, outputs


@pytest.mark.slow
@pytest.mark.parametrize("variant", SHORT)
def test_alone_or_among_8192(variant):
    """Streams depend on the table's index, so the lone table is taken out of the crowd and played beside it."""
    crowd = Tables(variant, 8192, seed=3, max_cycles=15)
    picked = [0, 17, 8191]
    alone = [Tables(variant, 1, seed=9, max_cycles=15) for _ in picked]
    for table, i in zip(alone, picked, strict=True):
        table.restore(crowd.snapshot([i]))
    episodes = crowd.states["episode"][picked].copy()
    for actions in actions_for(crowd, 40):
        crowd.step(actions)
        for table, i in zip(alone, picked, strict=True):
            table.step(actions[[i]])
            assert_same(outputs(table), outputs(crowd, [i]))
    assert (crowd.states["episode"][picked] >= episodes + 2).all()  # through automatic resets


@pytest.mark.parametrize("variant", SHORT)
def test_the_first_tables_of_a_batch_do_not_depend_on_its_size(variant):
    few, many = Tables(variant, 3, seed=3), Tables(variant, 50, seed=3)
    for actions in actions_for(many, 30):
        few.step(actions[:3])
        many.step(actions)
        assert_same(outputs(few), outputs(many, slice(3)))


@pytest.mark.slow
@pytest.mark.parametrize("variant", SHORT)
def test_one_thread_or_more(variant):
    one, two, three = (Tables(variant, 500, seed=3, threads=n, max_cycles=15) for n in (1, 2, 3))
    for actions in actions_for(one, 40):
        for tables in (one, two, three):
            tables.step(actions)
        assert_same(outputs(one), outputs(two))
        assert_same(outputs(one), outputs(three))
    two.close()
    three.close()


@pytest.mark.parametrize("tables, threads", [(1, 1), (5, 3), (500, 2), (2048, 2), (8191, 16)])
def test_threads_share_all_tables(tables, threads):
    """Ranges join up and are taken by size; the last ones are a small part of what a thread does."""
    ranges = kernels.ranges(tables, threads)
    assert [a for a, _ in ranges] + [tables] == [0] + [b for _, b in ranges]
    sizes = [b - a for a, b in ranges]
    assert min(sizes) > 0 and sizes == sorted(sizes, reverse=True)
    if tables >= 1000:
        assert len(sizes) > 2 * threads and sizes[-1] <= 0.1 * tables / threads + 64


@pytest.mark.parametrize("variant", ["match-randomized-v0", "attack-v0", "match-sensors-v0"])
def test_final_observations_are_the_ended_ones(variant):
    """What a batch keeps of an episode's end is what a batch without automatic reset shows there."""
    going, stopping = Tables(variant, 32, seed=2, max_cycles=9), Tables(variant, 32, autoreset=False, max_cycles=9)
    ends = 0
    for actions in actions_for(going, 30):
        stopping.restore(going.snapshot())
        going.step(actions)
        stopping.step(actions)
        ended = going.terminated | going.truncated
        assert (ended == (stopping.terminated | stopping.truncated)).all()
        assert going.final_observations[ended].tobytes() == stopping.observations[ended].tobytes()
        assert going.observations[~ended].tobytes() == stopping.observations[~ended].tobytes()
        assert (going.final_observations[ended] != going.observations[ended]).any(axis=(1, 2)).all()
        assert (going.states["steps"][ended] == 0).all()
        ends += int(ended.sum())
    assert ends >= 90


@pytest.mark.parametrize("period", [1 / 120, 0.02, 0.1, 1.0])
@pytest.mark.parametrize("variant", SHORT)
def test_periods(variant, period):
    """Time passes as the period says, and what is seen stays in its space."""
    tables = Tables(variant, 8, seed=1, period=period)
    low, high = tables.observation_bounds
    begun = tables.states["episode"].copy()
    for n, actions in enumerate(actions_for(tables, 60), start=1):
        tables.step(actions)
        assert (tables.observations >= low).all() and (tables.observations <= high).all()
        assert np.isfinite(tables.rewards).all()
        first = tables.states["episode"] == begun
        np.testing.assert_allclose(tables.states["time"][first], n * period, rtol=1e-12)
    limit = find_variant(variant).step_limit
    assert tables.variant.step_limit == round(limit * 0.1 / period)


def test_a_finer_period_is_the_same_table():
    """A puck that nobody touches is after 1 s where it is after 10 or 120 steps."""
    places = []
    for period in (1 / 120, 0.1, 0.5):
        tables = Tables("match-v0", 16, seed=4, period=period, parameters={"mallet_radius": 0.02})
        home = tables.observations[:, :, :2]
        stay = np.concatenate([home, np.full((16, 2, 2), 0.3, np.float32)], axis=2)
        for _ in range(round(1.0 / period)):
            tables.step(stay)
        names = [column.name for column in tables.observation_columns]
        places.append(tables.observations[:, 0, names.index("puck_x") : names.index("puck_y") + 1].copy())
    np.testing.assert_allclose(places[0], places[1], atol=1e-5)
    np.testing.assert_allclose(places[0], places[2], atol=1e-5)
