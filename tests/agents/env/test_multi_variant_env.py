"""Several variants as one vector environment: each plays as it would alone, in its own rows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

from agents.env.learner_env import POLICY, PRIVILEGED, LearnerEnv
from agents.env.multi_variant_env import MultiVariantVectorEnv, input_mappings
from agents.env.rewards import Rewards
from agents.league.matchmaking import Matchmaking
from agents.policy.policy import PolicyPlayer
from agents.training.ppo import FINAL_OBSERVATIONS, TIME_OUTS
from agents.training.preset import read_preset
from baselines.player import Seat
from puckpilot_env.tables import Tables
from tests.agents.training.tiny import TINY, curve, training

VARIANTS = (("match-randomized-v0", 3, None), ("defence-v0", 2, 4), ("attack-v0", 2, 3))
TWO_VARIANTS = (
    TINY
    + """
[[beside]]
variant = "attack-v0"
tables = 8
anchors = { still = 2, random = 2 }
earlier = [2]
"""
)


def make_envs() -> list[LearnerEnv]:
    batches = [Tables(name, n, seed=3, max_cycles=limit) for name, n, limit in VARIANTS]
    mappings, _ = input_mappings(batches)
    return [
        LearnerEnv(
            tables, Matchmaking.from_block_sizes(len(tables), []), mapping, Rewards(goal=1.0), gamma=0.9, mirror=True,
            critic="state",
        )
        for tables, mapping in zip(batches, mappings, strict=True)
    ]  # fmt: skip


def test_every_variant_plays_as_it_would_alone() -> None:
    env, alone = MultiVariantVectorEnv(make_envs()), make_envs()
    assert env.num_envs == 14
    rng, cuts = np.random.default_rng(1), 0
    for _ in range(12):
        actions = torch.from_numpy(rng.uniform(-1.0, 1.0, (14, 4)).astype(np.float32))
        seen, rewards, dones, extras = env.step(actions)
        first = 0
        finals = []
        for single in alone:
            rows = slice(first, first + single.num_envs)
            own = single.step(actions[rows])
            assert torch.equal(seen[POLICY][rows], own[0][POLICY])
            assert torch.equal(seen[PRIVILEGED][rows], own[0][PRIVILEGED])
            assert torch.equal(rewards[rows], own[1]) and torch.equal(dones[rows], own[2])
            cut = own[3].get(TIME_OUTS, torch.zeros(single.num_envs, dtype=torch.bool))
            assert torch.equal(extras[TIME_OUTS][rows], cut) if extras else not cut.any()
            finals += [own[3][FINAL_OBSERVATIONS][POLICY]] if own[3] else []
            first = rows.stop
        if extras:
            cuts += int(extras[TIME_OUTS].sum())
            assert torch.equal(extras[FINAL_OBSERVATIONS][POLICY], torch.cat(finals))
    assert cuts > 4


def test_columns_that_a_variant_lacks_are_read_as_the_middle_of_their_range() -> None:
    batches = [Tables(name, n, seed=3) for name, n, _ in VARIANTS]
    mappings, columns = input_mappings(batches)
    seen = mappings[1].inputs(batches[1].observations[:, 0])
    assert columns == [column.name for column in batches[0].observation_columns]
    absent = [columns.index(name) for name in ("seen", "gantry_c5_x", "own_score", "held")]
    shown = [columns.index(name) for name in ("mallet_x", "puck_x", "puck_y")]
    assert (seen[:, absent] == 0.0).all() and (seen[:, shown] != 0.0).all()


def test_a_run_at_several_variants_resumes_and_its_player_plays_each(tmp_path: Path) -> None:
    preset = read_preset(TWO_VARIANTS, "beside")
    unbroken = training(tmp_path / "a", preset=preset)
    for _ in range(3):
        row = unbroken.round()
    training(tmp_path / "b", preset=preset).round()
    for _ in range(2):
        training(tmp_path / "b", preset=preset, resume=True).round()
    assert curve(tmp_path / "a") == curve(tmp_path / "b")
    assert {"points_still", "points_still@attack-v0", "wins_random@attack-v0"} <= set(row)
    own, beside = unbroken.league.anchors_of(""), unbroken.league.anchors_of("attack-v0")
    assert [member.label for member in own] == ["still", "random"]
    assert [member.label for member in beside] == ["still@attack-v0", "random@attack-v0"]
    assert sum(member.games.sum() for member in beside) > 0.0
    for variant in ("match-v0", "attack-v0", "match-randomized-v0"):
        tables = Tables(variant, 2)
        actions = PolicyPlayer(unbroken.policy(), Seat.from_tables(tables)).act(tables.observations[:, 0])
        assert np.ptp(actions, axis=0).max() > 0.0


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ('variant = "chess-v0"', "unknown variant 'chess-v0'"),
        ("tables = 0", "puckpilot/attack-v0 is 0; expected a whole number"),
        ("earlier = [2, 0]", "puckpilot/attack-v0 is 0; expected a whole number"),
        ("players = 3", "players"),
    ],
)
def test_invalid_extra_variants_are_refused(line: str, said: str) -> None:
    head, tail = TWO_VARIANTS.split("[[beside]]")
    name = line.split()[0]
    kept = [one for one in tail.splitlines() if not one.startswith(f"{name} =")]
    with pytest.raises(ValueError, match=said) as error:
        read_preset(head + "[[beside]]\n" + "\n".join([*kept, line]), "beside")
    assert "\n" not in str(error.value)
