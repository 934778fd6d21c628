"""rsl-rl's environment: a batch of tables as the learner sees it, opponents included.

The path of an action: network's output -> flipped back -> scaled to the action space -> the learner's rows of all
tables; opponents fill theirs; one step; the learner's rows of observations, rewards and endings come back as tensors.
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

from agents.ppo import CUT, FINAL
from agents.privileged import SIDEWAYS, seen_state, true_state
from agents.rewards import Rewards
from agents.scaling import ACTION_FLIP, Reading
from agents.seating import Seating
from agents.tally import Tally
from baselines.player import Player
from puckpilot_env.game.rules import SHOT
from puckpilot_env.tables import Tables

POLICY, PRIVILEGED = "policy", "privileged"


class LearnerEnv(VecEnv):
    """The learner's rows of `tables`, as `seating` has them; `opponents` sit in its blocks, in order.

    Observations: "policy" (rows, d), what a player sees, scaled; "privileged" (rows, ..), what only the critic may
    know: the share of points that the learner wins against this opponent, from -1 for none to 1 for all, and, for a
    `critic` of the "state", the table as it truly is (see `privileged`). On every other pair of tables the learner sees
    and plays the left-right flipped game, if `flip`: half its experience is of either hand, at no cost.
    """

    def __init__(
        self, tables: Tables, seating: Seating, reading: Reading, rewards: Rewards, *, gamma: float, flip: bool,
        critic: str = "score",
    ) -> None:  # fmt: skip
        self.tables, self.seating, self.rewards, self.gamma = tables, seating, rewards, gamma
        self.tally = Tally(seating)
        self.reading = reading
        self.critic = critic
        self.opponents: Sequence[Player] = ()
        self.shares = np.zeros((len(seating.learners), 1), np.float32)
        self.num_envs, self.num_actions = len(seating.learners), 4
        self.max_episode_length = tables.variant.step_limit or round(tables.variant.match_time / tables.variant.period)
        self.episode_length_buf = torch.zeros(self.num_envs, dtype=torch.long)
        self.device = "cpu"  # where the tables are
        self.cfg: dict[str, Any] = {"variant": tables.variant.id}
        self._at = seating.learners // 2
        self._actions = np.zeros((2 * len(tables), 4), np.float32)
        flipped = (self._at // 2) % 2 == 1 if flip else np.zeros(self.num_envs, np.bool_)
        self._see = np.where(flipped[:, None], reading.scaling.flip, np.float32(1.0)).astype(np.float32)
        self._play = np.where(flipped[:, None], ACTION_FLIP, np.float32(1.0)).astype(np.float32)

    def seat(self, opponents: Sequence[Player], shares: Sequence[float]) -> None:
        """Let these sit in the blocks from now on; `shares` (0 to 1): points that the learner wins against each."""
        self.opponents = opponents
        self.shares[:] = 0.0  # against itself it wins half of them
        for block, player, share in zip(self.seating.blocks, opponents, shares, strict=True):
            self.shares[self.seating.learners_of(block)] = 2.0 * share - 1.0
            player.reset(np.ones(block.last - block.first, np.bool_))

    def get_observations(self) -> TensorDict:
        """What the learner sees now."""
        return self._seen(self.tables.observations, slice(None))

    def step(self, actions: Tensor) -> tuple[TensorDict, Tensor, Tensor, dict[str, Any]]:
        """Play one step with (rows, 4) outputs in -1 to 1; see `ppo` for what is in the extras."""
        tables, at = self.tables, self._at
        own = self.reading.scaling.action(actions.cpu().numpy() * self._play)
        self._actions[self.seating.learners] = own
        flat = tables.observations.reshape(self._actions.shape[0], -1)
        for block, player in zip(self.seating.blocks, self.opponents, strict=True):
            self._actions[block.rows] = player.act(flat[block.rows])
        score, before = tables.states["score"].copy(), self.rewards.before(tables)
        tables.step(self._actions.reshape(len(tables), 2, 4))
        done = tables.terminated | tables.truncated
        scored = np.where(done[:, None], tables.states["last_score"], tables.states["score"]) - score
        into = np.flatnonzero(tables.states["ending"] == SHOT)  # a drill ends before the puck is there
        scored[into, tables.states["winner"][into]] += 1
        rewards = self.rewards.after(tables, before, scored, done, self.gamma).reshape(-1)[self.seating.learners]
        self.tally.add(scored, done, tables.states["winner"])
        self._tell_opponents(done)
        extras: dict[str, Any] = {}
        if tables.truncated.any():
            cut = tables.truncated[at]
            extras = {CUT: torch.from_numpy(cut), FINAL: self._seen(tables.final_observations, cut)}
        dones = torch.from_numpy(done[at].astype(np.int64))
        return self.get_observations(), torch.from_numpy(rewards), dones, extras

    def _tell_opponents(self, done: NDArray[np.bool_]) -> None:
        if done.any():
            for block, player in zip(self.seating.blocks, self.opponents, strict=True):
                player.reset(done[block.first : block.last])

    def _seen(self, observations: NDArray[np.float32], which: Any) -> TensorDict:
        """The learner's view of (n, 2, columns) observations, of its rows in `which`: a slice for now, a mask for the
        ends of episodes that are over."""
        rows = self.seating.learners[which]
        flat = observations.reshape(self._actions.shape[0], -1)
        policy = self.reading.seen(flat[rows]) * self._see[which]
        known = [self.shares[which]]
        if self.critic == "state":
            over = not isinstance(which, slice)
            state = seen_state(self.tables, rows, flat[rows]) if over else true_state(self.tables, rows)
            known.append(np.where(self._play[which, 1:2] < 0.0, SIDEWAYS, 1.0).astype(np.float32) * state)
        parts = {POLICY: torch.from_numpy(policy), PRIVILEGED: torch.from_numpy(np.hstack(known))}
        return TensorDict(parts, batch_size=[len(rows)])
