"""Tables of several variants as one environment: each part plays as it would alone, and its rows stay its own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch
from tiny import TINY, curve, training

from agents.hall import Hall, readings
from agents.learner_env import POLICY, PRIVILEGED, LearnerEnv
from agents.policy import PolicyPlayer
from agents.ppo import CUT, FINAL
from agents.preset import read_preset
from agents.rewards import Rewards
from agents.seating import Seating
from baselines.player import Seat
from puckpilot_env.tables import Tables

VARIANTS = (("match-randomized-v0", 3, None), ("defence-v0", 2, 4), ("attack-v0", 2, 3))
BESIDE = (
    TINY
    + """
[[beside]]
variant = "attack-v0"
tables = 8
anchors = { still = 2, random = 2 }
earlier = [2]
"""
)


def parts() -> list[LearnerEnv]:
    batches = [Tables(name, n, seed=3, max_cycles=limit) for name, n, limit in VARIANTS]
    read, _ = readings(batches)
    return [
        LearnerEnv(t, Seating.of(len(t), []), r, Rewards(goal=1.0), gamma=0.9, flip=True, critic="state")
        for t, r in zip(batches, read, strict=True)
    ]


def test_every_part_plays_as_it_would_alone() -> None:
    hall, alone = Hall(parts()), parts()
    assert hall.num_envs == 14
    rng, cuts = np.random.default_rng(1), 0
    for _ in range(12):
        actions = torch.from_numpy(rng.uniform(-1.0, 1.0, (14, 4)).astype(np.float32))
        seen, rewards, dones, extras = hall.step(actions)
        first = 0
        finals = []
        for part in alone:
            rows = slice(first, first + part.num_envs)
            own = part.step(actions[rows])
            assert torch.equal(seen[POLICY][rows], own[0][POLICY])
            assert torch.equal(seen[PRIVILEGED][rows], own[0][PRIVILEGED])
            assert torch.equal(rewards[rows], own[1]) and torch.equal(dones[rows], own[2])
            cut = own[3].get(CUT, torch.zeros(part.num_envs, dtype=torch.bool))
            assert torch.equal(extras[CUT][rows], cut) if extras else not cut.any()
            finals += [own[3][FINAL][POLICY]] if own[3] else []
            first = rows.stop
        if extras:
            cuts += int(extras[CUT].sum())
            assert torch.equal(extras[FINAL][POLICY], torch.cat(finals))
    assert cuts > 4


def test_what_a_variant_does_not_show_is_read_as_the_middle() -> None:
    batches = [Tables(name, n, seed=3) for name, n, _ in VARIANTS]
    read, columns = readings(batches)
    seen = read[1].seen(batches[1].observations[:, 0])
    assert columns == [column.name for column in batches[0].observation_columns]
    absent = [columns.index(name) for name in ("seen", "gantry_c5_x", "own_score", "held")]
    shown = [columns.index(name) for name in ("mallet_x", "puck_x", "puck_y")]
    assert (seen[:, absent] == 0.0).all() and (seen[:, shown] != 0.0).all()


def test_a_run_at_several_variants_is_resumed_and_its_player_plays_each(tmp_path: Path) -> None:
    preset = read_preset(BESIDE, "beside")
    unbroken = training(tmp_path / "a", preset=preset)
    for _ in range(3):
        row = unbroken.round()
    training(tmp_path / "b", preset=preset).round()
    for _ in range(2):
        training(tmp_path / "b", preset=preset, resume=True).round()
    assert curve(tmp_path / "a") == curve(tmp_path / "b")
    assert {"points_still", "points_still@attack-v0", "wins_random@attack-v0"} <= set(row)
    own, beside = unbroken.league.of(""), unbroken.league.of("attack-v0")
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
def test_tables_beside_that_cannot_be_are_refused(line: str, said: str) -> None:
    head, tail = BESIDE.split("[[beside]]")
    name = line.split()[0]
    kept = [one for one in tail.splitlines() if not one.startswith(f"{name} =")]
    with pytest.raises(ValueError, match=said) as error:
        read_preset(head + "[[beside]]\n" + "\n".join([*kept, line]), "beside")
    assert "\n" not in str(error.value)
