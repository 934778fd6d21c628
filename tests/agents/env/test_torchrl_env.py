"""Many tables as TorchRL's environment: the library's own check, and the same games as the tables play themselves."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import torch

from puckpilot_env import all_variants
from puckpilot_env.tables import Tables

MISSING = "TorchRL is not installed; it comes with pip install '.[test]'"
torchrl_env = pytest.importorskip("agents.env.torchrl_env", reason=MISSING)
checks = pytest.importorskip("torchrl.envs.utils", reason=MISSING)

pytestmark = pytest.mark.filterwarnings("ignore")  # TorchRL's own, of versions and defaults to come
SEAT = "player"


@pytest.mark.parametrize("variant", list(all_variants()))
def test_the_check_of_the_library_passes(variant: str) -> None:
    checks.check_env_specs(torchrl_env.torchrl_env(variant, 3))


def test_it_plays_the_games_of_the_tables_and_hands_out_the_last_observation_of_each() -> None:
    env = torchrl_env.torchrl_env("attack-randomized-v0", 4)
    env.set_seed(5)
    steps = env.rollout(200, break_when_any_done=False)
    tables = Tables("attack-randomized-v0", 4, seed=5)
    ended = 0
    for at in range(200):
        step = steps[:, at]
        np.testing.assert_array_equal(step[SEAT, "observation"], tables.observations)
        tables.step(step[SEAT, "action"].numpy())
        over = tables.terminated | tables.truncated
        np.testing.assert_array_equal(step["next", "done"][:, 0], over)
        np.testing.assert_array_equal(step["next", SEAT, "terminated"][:, 1, 0], tables.terminated)
        np.testing.assert_array_equal(step["next", SEAT, "reward"][..., 0], tables.rewards)
        then = step["next", SEAT, "observation"].numpy()
        np.testing.assert_array_equal(then[over], tables.final_observations[over])
        np.testing.assert_array_equal(then[~over], tables.observations[~over])
        ended += over.sum()
    assert ended > 3


def test_a_seed_counts_for_one_reset_and_makes_the_same_games() -> None:
    env = torchrl_env.torchrl_env("match-v0", 2)

    def first() -> Any:
        return env.reset()[SEAT, "observation"].clone()

    env.set_seed(1)
    once, then = first(), first()
    env.set_seed(1)
    assert torch.equal(first(), once) and not torch.equal(then, once)


def test_a_table_in_the_midst_of_an_episode_is_not_reset_alone() -> None:
    env = torchrl_env.torchrl_env("match-v0", 3)
    state = env.reset()
    state["_reset"] = torch.tensor([[False], [True], [False]])
    with pytest.raises(ValueError, match="table 1 is asked to begin anew in the midst of an episode"):
        env.reset(state)


def test_tables_that_stop_at_an_end_are_refused() -> None:
    with pytest.raises(ValueError, match="expected Tables with autoreset=True"):
        torchrl_env.TorchRLEnv(Tables("match-v0", 2, autoreset=False))
