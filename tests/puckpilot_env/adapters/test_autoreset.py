"""Both ways in which a vector environment begins the next episode, and Gymnasium's own wrappers over them."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import data_equivalence
from gymnasium.wrappers.vector import NormalizeObservation, NormalizeReward, RecordEpisodeStatistics

import puckpilot_env  # noqa: F401 - registers the ids
from baselines.gymnasium_seat import make_seats

DRILL = "puckpilot/defence-randomized-v0"  # short episodes, and something is drawn for each
MODES = ("SameStep", "NextStep")


def sampled(envs: gymnasium.vector.VectorEnv, count: int) -> list[np.ndarray]:
    envs.action_space.seed(7)
    return [envs.action_space.sample() for _ in range(count)]


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("id_", [DRILL, "puckpilot/attack-v0"])
def test_vector_of_one_is_what_gymnasium_would_make_of_the_single_env(id_: str, mode: str) -> None:
    options = {"opponent": "interceptor", "max_cycles": 12}
    theirs = gymnasium.make_vec(id_, 1, vectorization_mode="sync", vector_kwargs={"autoreset_mode": mode}, **options)
    ours = gymnasium.make_vec(id_, 1, autoreset_mode=mode, **options)
    assert theirs.single_action_space == ours.single_action_space
    assert theirs.observation_space == ours.observation_space
    assert ours.metadata["autoreset_mode"] == theirs.metadata["autoreset_mode"]
    assert data_equivalence(theirs.reset(seed=3), ours.reset(seed=3), exact=True)
    ends = 0
    for action in sampled(ours, 80):
        expected, found = theirs.step(action), ours.step(action)
        assert data_equivalence(expected, found, exact=True), (expected, found)
        ends += bool((found[2] | found[3]).any())
    assert ends >= 4


@pytest.mark.parametrize("opponent", ["still", "veteran"])
def test_episodes_are_the_same_whichever_step_they_begin_in(opponent: str) -> None:
    """Every table goes left and right by its own count of steps, so that both ways see the same actions."""
    low, high = make_seats(DRILL, 1).tables.action_bounds
    seen: dict[str, list[list[bytes]]] = {}
    for mode in MODES:
        envs = make_seats(DRILL, 6, opponent, autoreset_mode=mode)
        rows, _ = envs.reset(seed=5)
        played, count, begins = [[row.tobytes()] for row in rows], np.zeros(6), np.zeros(6, bool)
        for _ in range(120):
            share = 0.5 + 0.4 * np.sin(count)[:, None]
            rows, rewards, terminated, truncated, infos = envs.step((low + share * (high - low)).astype(np.float32))
            for table in range(6):
                if mode == "NextStep" and begins[table]:
                    assert rewards[table] == 0.0 and not terminated[table] and not truncated[table]
                elif mode == "SameStep" and (terminated | truncated)[table]:
                    played[table] += [rewards[table].tobytes(), infos["final_obs"][table].tobytes()]
                else:
                    played[table].append(rewards[table].tobytes())
                played[table].append(rows[table].tobytes())
            count = np.where(begins if mode == "NextStep" else terminated | truncated, 0, count + 1)
            begins = terminated | truncated
        seen[mode] = played
    for same, late in zip(*seen.values(), strict=True):
        assert same[: len(late)] == late[: len(same)] and len(late) > 200


def test_what_ended_and_what_began_is_told_in_the_step_in_which_it_is_seen() -> None:
    envs = make_seats(DRILL, 16, "still", autoreset_mode="NextStep")
    _, infos = envs.reset(seed=1)
    assert infos["_parameters"].all() and "ending" not in infos
    before, ends = np.zeros(16, bool), 0
    for actions in sampled(envs, 60):
        _, _, terminated, truncated, infos = envs.step(actions)
        ended = terminated | truncated
        assert "final_obs" not in infos
        np.testing.assert_array_equal(infos.get("_parameters", np.zeros(16, bool)), before)
        np.testing.assert_array_equal(infos.get("_ending", np.zeros(16, bool)), ended)
        if ended.any():
            won = np.array([name == "player_0" for name in infos["winner"]])
            np.testing.assert_array_equal(infos["is_success"], won)
            np.testing.assert_array_equal(infos["outcome"] == 1, won)
        before, ends = ended, ends + int(ended.sum())
    assert ends > 20


def test_gymnasiums_wrappers_normalize_what_waits_for_the_next_step() -> None:
    envs = gymnasium.make_vec(DRILL, 8, opponent="still", autoreset_mode="NextStep")
    envs = RecordEpisodeStatistics(NormalizeReward(NormalizeObservation(envs)))
    envs.reset(seed=2)
    rows = []
    lengths: list[int] = []
    for actions in sampled(envs, 200):
        row, *_, infos = envs.step(actions)
        rows.append(row)
        if "episode" in infos:
            lengths += infos["episode"]["l"][infos["_episode"]].tolist()
    assert len(lengths) > 40 and min(lengths) >= 1
    spread = np.std(np.concatenate(rows[100:]), axis=0)
    assert 0.5 < np.median(spread) < 2.0
