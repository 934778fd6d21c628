"""The option `reward="sparse"`: nothing but goals of a match, and who won a drill, counts."""

from __future__ import annotations

import numpy as np
import pettingzoo
import pytest

from baselines import make_player
from baselines.gymnasium_seat import make_seat, make_seats
from baselines.player import Seat
from puckpilot_env.tables import Tables
from puckpilot_env.variants import all_variants


def played(variant: str, reward: str | None, steps: int, period: float | None = None) -> tuple[list, ...]:
    """Rewards, scores before and after, and how episodes ended, of tables at which an interceptor meets itself."""
    tables = Tables(variant, 24, seed=3, reward=reward, period=period, autoreset=False)
    players = [make_player("interceptor", Seat.from_tables(tables, seed)) for seed in (1, 2)]
    rewards, leads, ended, winners = [], [], [], []
    for _ in range(steps):
        before = tables.states["score"].copy()
        tables.step(np.stack([player.act(tables.observations[:, k]) for k, player in enumerate(players)], axis=1))
        rewards.append(tables.rewards.copy())
        leads.append(np.diff(tables.states["score"] - before, axis=1)[:, 0])
        ended.append(tables.terminated | tables.truncated)
        winners.append(tables.states["winner"].copy())
        if ended[-1].any():
            break
    return rewards, leads, ended, winners


def test_goals_of_a_match_are_all_that_is_rewarded() -> None:
    rewards, leads, *_ = played("match-v0", "sparse", 400)
    for step, lead in zip(rewards, leads, strict=True):
        np.testing.assert_array_equal(step, np.stack([-lead, lead], axis=1))
    assert np.abs(leads).sum() > 20


@pytest.mark.parametrize("variant", ["defence-v0", "attack-v0", "defence-randomized-v0"])
def test_who_won_a_drill_is_all_that_is_rewarded(variant: str) -> None:
    tables = Tables(variant, 400, seed=5, reward="sparse", autoreset=False)
    players = [make_player(name, Seat.from_tables(tables)) for name in ("random", "bank_shot")]
    over, paid = np.zeros(400, bool), set()
    for _ in range(100):
        tables.step(np.stack([player.act(tables.observations[:, k]) for k, player in enumerate(players)], axis=1))
        winner = tables.states["winner"]
        for player in range(2):
            expected = np.where(winner < 0, 0.0, np.where(winner == player, 1.0, -1.0)) * tables.terminated
            np.testing.assert_array_equal(tables.rewards[~over, player], expected[~over])
        paid |= set(tables.rewards[~over, 0].tolist())
        over |= tables.terminated | tables.truncated
    assert paid == {-1.0, 0.0, 1.0}


def test_the_game_is_the_same_and_shaped_is_the_default() -> None:
    shaped, sparse, default = (played("match-v0", reward, 200) for reward in ("shaped", "sparse", None))
    assert np.array_equal(shaped[0], default[0]) and not np.array_equal(shaped[0], sparse[0])
    assert np.array_equal(shaped[1], sparse[1])


@pytest.mark.parametrize("id_", all_variants())
def test_every_interface_takes_it(id_: str) -> None:
    env = pettingzoo.make("parallel", id_, reward="sparse")
    env.reset(seed=0)
    (*_,) = env.step({agent: env.action_space(agent).sample() for agent in env.agents})
    assert make_seat(id_, reward="sparse").tables.variant.sparse_reward
    assert make_seats(id_, 2, reward="sparse").tables.variant.sparse_reward
    with pytest.raises(ValueError, match="reward is 'dense'; expected None, 'shaped' or 'sparse'"):
        Tables(id_, 1, reward="dense")
