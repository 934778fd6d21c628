"""The learner's environment, checked against a copy of its tables that is stepped by hand."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from numpy.typing import NDArray

from agents.env.learner_env import POLICY, PRIVILEGED, LearnerEnv
from agents.env.rewards import Rewards
from agents.league.matchmaking import Matchmaking
from agents.policy.scaling import InputMapping, Scaling
from agents.training.ppo import FINAL_OBSERVATIONS, TIME_OUTS
from baselines.player import Player, Seat
from puckpilot_env.tables import Tables
from tests.agents.policy.mirrored_tables import mirrored_left_right, observed

N = 9  # tables 0 to 3 self-play, 4 to 5 against one, 6 to 8 against another
SIZES = [2, 3]
# by hand: the learner's rows in the order of its batch, and each opponent's (at even tables it is player 1)
LEARNERS = [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1), (3, 0), (3, 1), (4, 0), (5, 1), (6, 0), (7, 1), (8, 0)]
OPPONENTS = [[(4, 1), (5, 0)], [(6, 1), (7, 0), (8, 1)]]
MIRRORED = (2, 3, 6, 7)  # every other pair of tables
VARIANT_REWARD = Rewards(rules=1.0)


class Recorder(Player):
    """Records its observations and which games start; plays random actions of its own."""

    def __init__(self, seat: Seat, number: int) -> None:
        super().__init__(seat)
        self.seen: list[NDArray[np.float32]] = []
        self.begun: list[NDArray[np.bool_]] = []
        self.played: list[NDArray[np.float32]] = []
        self.rng = np.random.default_rng(number)

    def reset(self, mask: NDArray[np.bool_]) -> None:
        self.begun.append(mask.copy())

    def act(self, observation: NDArray[np.float32]) -> NDArray[np.float32]:
        self.seen.append(observation.copy())
        low, high = self.seat.action_bounds
        self.played.append(self.rng.uniform(low, high, (len(observation), 4)).astype(np.float32).clip(low, high))
        return self.played[-1]


def made(
    variant: str = "match-v0", mirror: bool = False, rewards: Rewards = VARIANT_REWARD, **options
) -> tuple[LearnerEnv, list[Recorder]]:
    tables = Tables(variant, N, seed=6, **options)
    names = [column.name for column in tables.observation_columns]
    input_mapping = InputMapping.by_name(Scaling.from_tables(tables), names, names)
    env = LearnerEnv(tables, Matchmaking.from_block_sizes(N, SIZES), input_mapping, rewards, gamma=0.9, mirror=mirror)
    seat = Seat.from_tables(tables)
    opponents = [Recorder(seat, number) for number in range(2)]
    env.set_opponents(opponents, [0.75, 0.1])
    return env, opponents


def rows(numbers: NDArray, seats: list[tuple[int, int]]) -> NDArray:
    return np.stack([numbers[table, player] for table, player in seats])


def outputs(seed: int) -> torch.Tensor:
    return torch.from_numpy(np.random.default_rng(seed).uniform(-1.0, 1.0, (len(LEARNERS), 4)).astype(np.float32))


def joint(tables: Tables, own: torch.Tensor, opponents: list[Recorder], mirrored: tuple[int, ...] = ()) -> NDArray:
    """(N, 2, 4) actions that everybody last played, put at their seats by hand."""
    low, high = tables.action_bounds.astype(np.float64)
    actions = np.zeros((N, 2, 4))
    for (table, player), output in zip(LEARNERS, own.double().numpy(), strict=True):
        action = low + (output + 1.0) / 2.0 * (high - low)
        if table in mirrored:
            action[1] = float(tables.nominal["width"][0]) - action[1]
        actions[table, player] = action
    for seats, opponent in zip(OPPONENTS, opponents, strict=True):
        for (table, player), action in zip(seats, opponent.played[-1], strict=True):
            actions[table, player] = action
    return actions.astype(np.float32).clip(*tables.action_bounds)


def test_every_player_observes_and_plays_its_own_seat() -> None:
    env, opponents = made()
    copy = Tables("match-v0", N, seed=6)
    for step in range(6):
        before = copy.observations.copy()
        own = outputs(step)
        seen, rewards, dones, extras = env.step(own)
        for seats, opponent in zip(OPPONENTS, opponents, strict=True):
            np.testing.assert_allclose(opponent.seen[-1], rows(before, seats), atol=2e-4)
        copy.step(joint(copy, own, opponents))
        np.testing.assert_allclose(env.tables.observations, copy.observations, atol=2e-4)
        expected = rows(copy.observations, LEARNERS)
        scaling = env.input_mapping.scaling
        np.testing.assert_allclose(
            np.asarray(seen[POLICY]) * scaling.span + scaling.centre, expected, rtol=1e-4, atol=1e-3
        )
        np.testing.assert_allclose(rewards.numpy(), rows(copy.rewards, LEARNERS), atol=1e-4)
        assert not dones.any() and dones.shape == rewards.shape == (len(LEARNERS),) and not extras


def test_a_mirrored_table_is_observed_and_played_mirrored() -> None:
    env, opponents = made(mirror=True)
    copy = Tables("match-v0", N, seed=6)
    for step in range(5):
        own = outputs(step)
        seen = np.asarray(env.step(own)[0][POLICY])
        copy.step(joint(copy, own, opponents, MIRRORED))
        mirror_view = observed(copy, mirrored_left_right(copy))
        shown = [(mirror_view if table in MIRRORED else copy.observations)[table, player] for table, player in LEARNERS]
        scaling = env.input_mapping.scaling
        np.testing.assert_allclose(seen * scaling.span + scaling.centre, np.stack(shown), rtol=1e-4, atol=1e-3)
        np.testing.assert_allclose(env.tables.observations, copy.observations, atol=2e-4)
    changed = np.abs(mirror_view - copy.observations)[list(MIRRORED)].max()
    assert changed > 0.1
    for seats, opponent in zip(OPPONENTS, opponents, strict=True):  # opponents are not mirrored
        assert (opponent.seen[0] == rows(Tables("match-v0", N, seed=6).observations, seats)).all()


def test_critic_observes_the_share_of_points_against_each_opponent() -> None:
    env, _ = made()
    privileged = np.asarray(env.get_observations()[PRIVILEGED])
    np.testing.assert_allclose(privileged[:, 0], [0.0] * 8 + [0.5] * 2 + [-0.8] * 3, atol=1e-6)


def test_extras_hold_the_final_observation_of_a_truncated_episode() -> None:
    """Tables end at different steps; the copy is not reset, so that its last observations stay."""
    env, opponents = made("defence-v0", max_cycles=4, mirror=True)
    copy = Tables("defence-v0", N, seed=6, max_cycles=4, autoreset=False)
    env.tables.states["steps"][4:] = copy.states["steps"][4:] = [0, 1, 2, 2, 2]
    ended, cuts = np.zeros(N, np.bool_), 0
    for step in range(4):
        own = outputs(step)
        _, _, dones, extras = env.step(own)
        copy.step(joint(copy, own, opponents, MIRRORED))
        now = (copy.terminated | copy.truncated) & ~ended
        cut = [seat for seat in LEARNERS if copy.truncated[seat[0]] and not ended[seat[0]]]
        first = [seat for seat in LEARNERS if not ended[seat[0]]]
        here = [LEARNERS.index(seat) for seat in first]
        assert dones.numpy()[here].tolist() == [int(now[table]) for table, _ in first]
        if cut:
            at = extras[TIME_OUTS].numpy()
            assert [at[LEARNERS.index(seat)] for seat in first] == [seat in cut for seat in first]
            assert len(extras[FINAL_OBSERVATIONS]) == at.sum() and extras[FINAL_OBSERVATIONS][PRIVILEGED].shape == (
                at.sum(),
                1,
            )
            kept = {LEARNERS[row]: i for i, row in enumerate(np.flatnonzero(at))}
            mirror_view, scaling = observed(copy, mirrored_left_right(copy)), env.input_mapping.scaling
            for table, player in cut:
                final = extras[FINAL_OBSERVATIONS][POLICY][kept[table, player]].numpy() * scaling.span + scaling.centre
                shown = (mirror_view if table in MIRRORED else copy.observations)[table, player]
                np.testing.assert_allclose(final, shown, rtol=1e-4, atol=1e-3)
                assert np.abs(env.tables.observations[table, player] - copy.observations[table, player]).max() > 0.05
        cuts += len(cut)
        ended |= now
    assert cuts > 6


def test_opponents_are_reset_where_their_games_start() -> None:
    env, opponents = made("defence-v0", max_cycles=3)
    env.tables.states["steps"][:] = [2, 2, 2, 2, 2, 0, 0, 2, 0]
    env.step(outputs(0))
    assert [one.begun[0].all() and len(one.begun[0]) == size for one, size in zip(opponents, SIZES, strict=True)]
    assert [one.begun[-1].tolist() for one in opponents] == [[True, False], [False, True, False]]


@pytest.mark.parametrize("scorer", [0, 1])
def test_a_goal_rewards_the_scorer_and_costs_the_other(scorer: int) -> None:
    """A fast puck right before the other's goal, in self-play and in both blocks; only goals are rewarded."""
    env, _ = made(rewards=Rewards(rules=0.0, goal=1.0))
    tables = env.tables
    for table in (1, 4, 7):
        puck = tables.states["puck"][table : table + 1]
        puck["x"], puck["y"] = (1.9, 0.5) if scorer == 0 else (0.1, 0.5)
        puck["vx"], puck["vy"] = (9.0, 0.0) if scorer == 0 else (-9.0, 0.0)
        for player, x in ((0, 0.4), (1, 1.6)):
            mallet = tables.states["mallets"][table : table + 1, player]
            mallet["x"]["rest"], mallet["y"]["rest"] = x, 0.1
    rewards = env.step(torch.full((len(LEARNERS), 4), -0.5))[1].numpy()
    found = dict(zip(LEARNERS, rewards.tolist(), strict=True))
    sign = 1.0 if scorer == 0 else -1.0
    assert {seat: reward for seat, reward in found.items() if reward} == {
        (1, 0): sign, (1, 1): -sign, (4, 0): sign, (7, 1): -sign,
    }  # fmt: skip
    points = [[1.0, 0.0], [0.0, 1.0]] if scorer == 0 else [[0.0, 1.0], [1.0, 0.0]]  # 4 is in block 0, 7 in block 1
    assert env.results.points.tolist() == points


def test_the_goal_that_ends_a_match_is_counted_and_so_is_the_match() -> None:
    env, _ = made(rewards=Rewards(rules=0.0, goal=2.0))
    tables = env.tables
    tables.states["score"][7] = [2, 6]  # the learner is player 1
    puck, mallets = tables.states["puck"][7:8], tables.states["mallets"][7:8]
    puck["x"], puck["y"], puck["vx"], puck["vy"] = 0.1, 0.5, -9.0, 0.0
    mallets["x"]["rest"], mallets["y"]["rest"] = [0.4, 1.6], 0.1
    _, rewards, dones, extras = env.step(torch.full((len(LEARNERS), 4), -0.5))
    at = LEARNERS.index((7, 1))
    assert (float(rewards[at]), int(dones[at]), int(dones.sum())) == (2.0, 1, 1) and not extras
    assert env.results.points[1].tolist() == [1.0, 0.0] and env.results.games.tolist() == [[0, 0, 0], [1, 0, 0]]
    assert tables.states["score"][7].tolist() == [0, 0]


def test_a_shot_that_ends_an_attack_drill_counts_as_a_goal() -> None:
    """A puck just before the middle line moves towards the middle of an empty goal, or past it."""
    tables = Tables("attack-v0", 2, seed=3)
    names = [column.name for column in tables.observation_columns]
    input_mapping = InputMapping.by_name(Scaling.from_tables(tables), names, names)
    env = LearnerEnv(
        tables,
        Matchmaking.from_block_sizes(2, [2]),
        input_mapping,
        Rewards(rules=0.0, goal=1.0),
        gamma=0.9,
        mirror=False,
    )
    env.set_opponents([Recorder(Seat.from_tables(tables), 1)], [0.5])
    p, puck = tables.nominal[0], tables.states["puck"]
    puck["x"], puck["vx"], puck["vy"] = 0.49 * p["length"], 6.0, 0.0
    puck["y"] = 0.5 * p["width"], 0.9 * p["width"]
    for axis in "xy":  # both mallets in a corner
        mallets = tables.states["mallets"][axis]
        mallets["rest"], mallets["slow"], mallets["fast"] = p["mallet_radius"], 0.0, 0.0
        mallets["rest"][:, 1] = p["length" if axis == "x" else "width"] - p["mallet_radius"]
    tables.states["subject"] = 0
    _, rewards, dones, _ = env.step(torch.full((2, 4), -1.0))
    assert dones.tolist() == [1, 1]
    assert rewards.tolist() == [1.0, 0.0]  # the learner is player 0 of the first table, player 1 of the other
    assert env.results.points.tolist() == [[1.0, 0.0]]
