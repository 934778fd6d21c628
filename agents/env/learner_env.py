"""rsl-rl's environment: a batch of tables as the learner sees it, opponents included.

The path of an action: the network's output is mirrored back where the table is played mirrored, scaled to the action
space, and written to the learner's rows of all tables. Opponents fill their own rows. After one step of the tables the
learner's rows of observations, rewards and endings are returned as tensors.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from rsl_rl.env import VecEnv
from tensordict import TensorDict
from torch import Tensor

from agents.env.privileged import STATE_MIRROR_SIGNS, observed_state, true_state
from agents.env.rewards import Rewards
from agents.league.block_results import BlockResults
from agents.league.matchmaking import Matchmaking
from agents.policy.scaling import ACTION_MIRROR_SIGNS, InputMapping
from agents.training.ppo import FINAL_OBSERVATIONS, TIME_OUTS
from baselines.player import Player
from puckpilot_env.game.rules import SHOT
from puckpilot_env.tables import Tables

POLICY, PRIVILEGED = "policy", "privileged"


class LearnerEnv(VecEnv):
    """The learner's rows of `tables`; one opponent plays in each block of `matchmaking`.

    Observations are a TensorDict of two entries. "policy" (rows, inputs): what a player sees, scaled for the network.
    "privileged" (rows, 1 or 7): what only the critic sees, which is the share of points that the learner wins against
    this opponent, from -1 (none) to 1 (all), and with `critic="state"` the true state of the table (see `privileged`).

    With `mirror` the learner sees and plays every second pair of tables mirrored left to right. The game is symmetric,
    so half of the experience is of either side, at no cost.
    """

    def __init__(
        self, tables: Tables, matchmaking: Matchmaking, input_mapping: InputMapping, rewards: Rewards, *,
        gamma: float, mirror: bool, critic: str = "score",
    ) -> None:  # fmt: skip
        """`gamma`: discount factor a step, for reward shaping; `critic`: "score" or "state"."""
        self.tables, self.matchmaking, self.rewards, self.gamma = tables, matchmaking, rewards, gamma
        self.results = BlockResults(matchmaking)
        self.input_mapping = input_mapping
        self.critic = critic
        self.opponents: Sequence[Player] = ()
        self.point_shares = np.zeros((len(matchmaking.learner_rows), 1), np.float32)
        self.num_envs, self.num_actions = len(matchmaking.learner_rows), 4
        self.max_episode_length = tables.variant.step_limit or round(tables.variant.match_time / tables.variant.period)
        self.episode_length_buf = torch.zeros(self.num_envs, dtype=torch.long)
        self.device = "cpu"  # where the tables are
        self.cfg = {"variant": tables.variant.id}
        self._table_of_row = matchmaking.learner_rows // 2
        self._actions = np.zeros((2 * len(tables), 4), np.float32)
        mirrored = (self._table_of_row // 2) % 2 == 1 if mirror else np.zeros(self.num_envs, np.bool_)
        signs, one = input_mapping.scaling.mirror_signs, np.float32(1.0)
        self._observation_signs = np.where(mirrored[:, None], signs, one).astype(np.float32)
        self._action_signs = np.where(mirrored[:, None], ACTION_MIRROR_SIGNS, one).astype(np.float32)

    def set_opponents(self, opponents: Sequence[Player], point_shares: Sequence[float]) -> None:
        """Let one opponent play in each block, in order, and start its games.

        `point_shares`: the share of points (0 to 1) that the learner wins against each.
        """
        self.opponents = opponents
        self.point_shares[:] = 0.0  # in self-play the learner wins half of the points
        for block, player, share in zip(self.matchmaking.blocks, opponents, point_shares, strict=True):
            self.point_shares[self.matchmaking.learner_slice(block)] = 2.0 * share - 1.0
            player.reset(np.ones(block.last - block.first, np.bool_))

    def get_observations(self) -> TensorDict:
        """The learner's current observations, `num_envs` rows."""
        return self._observe(self.tables.observations, slice(None))

    def step(self, actions: Tensor) -> tuple[TensorDict, Tensor, Tensor, dict[str, Any]]:
        """Play one step with the network's outputs (rows, 4) in -1 to 1.

        Returns observations, rewards (rows,) float32, dones (rows,) int64, and extras as `ppo.FinalStatePPO` expects
        them, empty where no episode was truncated.
        """
        tables = self.tables
        own = self.input_mapping.scaling.to_actions(actions.cpu().numpy() * self._action_signs)
        self._actions[self.matchmaking.learner_rows] = own
        flat = tables.observations.reshape(self._actions.shape[0], -1)
        for block, player in zip(self.matchmaking.blocks, self.opponents, strict=True):
            self._actions[block.opponent_rows] = player.act(flat[block.opponent_rows])
        score, before = tables.states["score"].copy(), self.rewards.measure(tables)
        tables.step(self._actions.reshape(len(tables), 2, 4))
        done = tables.terminated | tables.truncated
        scored = self._goals_scored(score, done)
        rewards = self.rewards.of_step(tables, before, scored, done, self.gamma)
        self.results.add(scored, done, tables.states["winner"])
        self._reset_opponents(done)
        extras: dict[str, Any] = {}
        if tables.truncated.any():
            truncated = tables.truncated[self._table_of_row]
            final = self._observe(tables.final_observations, truncated)
            extras = {TIME_OUTS: torch.from_numpy(truncated), FINAL_OBSERVATIONS: final}
        own_rewards = torch.from_numpy(rewards.reshape(-1)[self.matchmaking.learner_rows])
        dones = torch.from_numpy(done[self._table_of_row].astype(np.int64))
        return self.get_observations(), own_rewards, dones, extras

    def _goals_scored(self, score_before: NDArray[np.int64], done: NDArray[np.bool_]) -> NDArray[np.int64]:
        """(n, 2) goals of each player in the step just played. An attack drill ends before its shot is in the goal;
        the shot counts as a goal of the winner."""
        states = self.tables.states
        scored = np.where(done[:, None], states["last_score"], states["score"]) - score_before
        shots = np.flatnonzero(states["ending"] == SHOT)
        scored[shots, states["winner"][shots]] += 1
        return scored

    def _reset_opponents(self, done: NDArray[np.bool_]) -> None:
        """Call `Player.reset` of each opponent for its tables in `done` (n,)."""
        if done.any():
            for block, player in zip(self.matchmaking.blocks, self.opponents, strict=True):
                player.reset(done[block.first : block.last])

    def _observe(self, observations: NDArray[np.float32], which: Any) -> TensorDict:
        """The learner's observations out of (n, 2, columns) of all tables.

        `which` selects from the learner's rows: a slice for the present, a mask for rows whose episode has ended.
        """
        rows = self.matchmaking.learner_rows[which]
        flat = observations.reshape(self._actions.shape[0], -1)
        policy = self.input_mapping.inputs(flat[rows]) * self._observation_signs[which]
        privileged = [self.point_shares[which]]
        if self.critic == "state":
            ended = not isinstance(which, slice)
            state = observed_state(self.tables, rows, flat[rows]) if ended else true_state(self.tables, rows)
            mirrored = self._action_signs[which, 1:2] < 0.0
            privileged.append(np.where(mirrored, STATE_MIRROR_SIGNS, 1.0).astype(np.float32) * state)
        return TensorDict(
            {POLICY: torch.from_numpy(policy), PRIVILEGED: torch.from_numpy(np.hstack(privileged))},
            batch_size=[len(rows)],
        )
