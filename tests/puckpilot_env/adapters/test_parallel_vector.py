"""Both seats of many tables at once, held against PettingZoo's environment of one table."""

from __future__ import annotations

import numpy as np
import pettingzoo
import pytest

from puckpilot_env import parallel_vector_env
from puckpilot_env.adapters.infos import AGENTS
from puckpilot_env.tables import Tables

DRILL = "puckpilot/defence-randomized-v0"  # short episodes, and something is drawn for each


def shares(step: int, count: int) -> np.ndarray:
    """Shares (count, 2, 4) of the action space: other ones for every table and agent."""
    phase = 0.7 * step + np.arange(8 * count).reshape(count, 2, 4)
    return 0.5 + 0.45 * np.sin(phase)


def by_agent(env, step: int, count: int) -> dict[str, np.ndarray]:
    box = env.single_action_space("player_0")
    actions = (box.low + shares(step, count) * (box.high - box.low)).astype(np.float32)
    return {agent: actions[:, k] for k, agent in enumerate(AGENTS)}


@pytest.mark.parametrize("copy", [True, False])
def test_a_table_plays_as_the_environment_of_one(copy: bool) -> None:
    """The first table has the random stream of the environment of one; episodes end and begin within these steps."""
    envs, one = parallel_vector_env(DRILL, 3, copy=copy), pettingzoo.make("parallel", DRILL)
    seen, infos = envs.reset(seed=6)
    expected, drawn = one.reset(seed=6)
    ends = 0
    for step in range(150):
        for agent in AGENTS:
            np.testing.assert_array_equal(seen[agent][0], expected[agent])
            assert infos[agent]["parameters"]["friction"][0] == drawn[agent]["parameters"]["friction"]
        actions = by_agent(envs, step, 3)
        seen, rewards, terminations, truncations, now = envs.step(actions)
        last, paid, over, cut, ending = one.step({agent: actions[agent][0] for agent in AGENTS})
        for agent in AGENTS:
            assert (rewards[agent][0], terminations[agent][0]) == (np.float32(paid[agent]), over[agent])
            assert truncations[agent][0] == cut[agent]
        expected = last
        if not one.agents:
            ends += 1
            for agent in AGENTS:
                assert now[agent]["_final_obs"][0] and now[agent]["_outcome"][0]
                np.testing.assert_array_equal(now[agent]["final_obs"][0], last[agent])
                assert now[agent]["outcome"][0] == ending[agent]["outcome"]
                assert now[agent]["winner"][0] == ending[agent]["winner"]
            expected, drawn = one.reset()
            infos = now
    assert ends >= 3


def test_spaces_shapes_and_infos() -> None:
    envs = parallel_vector_env("match-v0", 5, threads=2)
    seen, infos = envs.reset(seed=1)
    assert envs.possible_agents == envs.agents == list(AGENTS) and infos == {agent: {} for agent in AGENTS}
    found = envs.step(by_agent(envs, 0, 5))
    for agent in AGENTS:
        assert envs.observation_space(agent).contains(seen[agent])
        assert envs.action_space(agent).contains(by_agent(envs, 0, 5)[agent])
        assert [part[agent].shape for part in found[:4]] == [(5, 21), (5,), (5,), (5,)]
    assert found[4] == {agent: {} for agent in AGENTS}
    envs.close()


def test_views_follow_the_tables_and_copies_do_not() -> None:
    for copy in (True, False):
        envs = parallel_vector_env("match-v0", 2, copy=copy)
        seen, _ = envs.reset(seed=1)
        before = {agent: rows.copy() for agent, rows in seen.items()}
        envs.step(by_agent(envs, 3, 2))
        for k, agent in enumerate(AGENTS):
            assert np.shares_memory(seen[agent], envs.tables.observations) is not copy
            assert np.array_equal(seen[agent], before[agent] if copy else envs.tables.observations[:, k])


def test_what_cannot_be_is_refused_in_one_line_and_changes_nothing() -> None:
    envs = parallel_vector_env("match-v0", 2)
    good = by_agent(envs, 0, 2)
    with pytest.raises(ValueError, match="call reset"):
        envs.step(good)
    envs.reset(seed=1)
    before = envs.tables.snapshot()
    for actions, words in (
        (None, "expected a dict with those of player_0 and player_1"),
        ({"player_0": good["player_0"]}, r"actions is for \['player_0'\]"),
        ({**good, "me": good["player_0"]}, "actions is for"),
        ({**good, "player_1": good["player_1"][:1]}, r"have shape \(1, 4\); expected \(2, 4\)"),
        ({**good, "player_1": np.full((2, 4), np.nan)}, "player_1 on table 0 is nan"),
    ):
        with pytest.raises(ValueError, match=words) as error:
            envs.step(actions)  # pyright: ignore[reportArgumentType]
        assert "\n" not in str(error.value)
    assert envs.tables.snapshot().states.tobytes() == before.states.tobytes()
    with pytest.raises(ValueError, match="num_envs is 0"):
        parallel_vector_env("match-v0", 0)
    with pytest.raises(ValueError, match="autoreset"):
        type(envs)(Tables("match-v0", 1, autoreset=False))
