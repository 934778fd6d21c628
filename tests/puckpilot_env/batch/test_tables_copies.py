"""Copies of a batch, by copy and by pickle, play on as the original does and share nothing with it."""

from __future__ import annotations

import copy
import pickle
import threading
from typing import Any

import gymnasium
import numpy as np
import pytest

from puckpilot_env import Tables, match_v0
from tests.puckpilot_env.batch.batches import actions_for, assert_same, outputs

WAYS = {"copy": copy.copy, "deepcopy": copy.deepcopy, "pickle": lambda given: pickle.loads(pickle.dumps(given))}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("threads", [1, 2])
def test_a_copy_plays_on_the_same_and_by_itself(way: str, threads: int) -> None:
    before = threading.active_count()
    tables = Tables("match-randomized-v0", 50, seed=1, threads=threads, max_cycles=12)
    script = actions_for(tables, 40)
    for actions in script[:10]:
        tables.step(actions)
    other = WAYS[way](tables)
    assert threading.active_count() == before + 2 * (threads - 1)
    start = outputs(tables)
    played = []
    for actions in script[10:]:
        other.step(actions)
        played.append(outputs(other))
    assert_same(start, outputs(tables))
    for actions, found in zip(script[10:], played, strict=True):
        tables.step(actions)
        assert_same(outputs(tables), found)
    tables.close()
    other.step(script[0])
    other.close()
    assert threading.active_count() == before


@pytest.mark.parametrize("way", WAYS)
def test_a_copy_of_a_closed_one_has_no_threads_and_plays_on(way: str) -> None:
    before = threading.active_count()
    tables = Tables("match-v0", 50, seed=1, threads=2)
    script = actions_for(tables, 20)
    tables.step(script[0])
    tables.close()
    other = WAYS[way](tables)
    for actions in script[1:]:
        tables.step(actions)
        other.step(actions)
        assert_same(outputs(tables), outputs(other))
    other.close()
    assert threading.active_count() == before


@pytest.mark.parametrize("way", ["deepcopy", "pickle"])
def test_environments_are_copied_with_their_tables(way: str) -> None:
    env: Any = match_v0.parallel_env()
    env.reset(seed=1)
    other = WAYS[way](env)
    actions = {agent: env.action_space(agent).sample() for agent in env.agents}
    for _ in range(5):
        mine, theirs = env.step(actions)[0], other.step(actions)[0]
        assert all(mine[agent].tobytes() == theirs[agent].tobytes() for agent in actions)
    seats: Any = gymnasium.make_vec("puckpilot/match-v0", num_envs=40, opponent="random", threads=2)
    seats.reset(seed=1)
    others = WAYS[way](seats)
    drawn = seats.action_space.sample()
    for _ in range(5):
        np.testing.assert_array_equal(seats.step(drawn)[0], others.step(drawn)[0])
    seats.close()
    others.close()
