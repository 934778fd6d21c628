"""The shipped player: its file says how it was made, and it wins."""

from __future__ import annotations

import csv

import numpy as np
import pytest

from agents.policy.mean_policy import mean_policy
from agents.policy.policy import SHIPPED, load_policy
from agents.training.preset import find_preset
from baselines.matches.match import play
from puckpilot_env.game.rules import ENDING_NAMES


@pytest.mark.parametrize(
    ("file", "words"),
    [
        ("champion.finish_goalie", "--preset finish_goalie --start out/champion"),
        ("champion.finish_veteran", "--preset finish_veteran --start out/finish_goalie"),
        ("champion", "--preset finish_still --start out/finish_still"),
        (
            "champion.match-randomized-v0",
            "--preset randomized_finish --variant match-randomized-v0 --start out/randomized",
        ),
        ("champion.attack-v0", "--preset attack_finish --variant attack-v0 --start out/attack"),
        (
            "champion.attack-randomized-v0",
            "--preset attack_randomized_finish --variant attack-randomized-v0 --start out/attack_randomized",
        ),
        ("champion.defence-v0", "--preset defence --variant defence-v0"),
        ("table_champion", "--preset fine_tune --start out/table_finish/policy.npz --at-table"),
        (
            "champion.defence-randomized-v0",
            "--preset defence --variant defence-randomized-v0 --start out/defence",
        ),
    ],
)
def test_the_file_names_its_command_and_its_curve_ends_at_its_steps(file: str, words: str) -> None:
    policy, preset = load_policy(SHIPPED / f"{file}.npz"), find_preset(words.split()[1])
    steps = policy.about["steps"]
    assert policy.about["command"] == f"puckpilot train {words} --seed {policy.about['seed']} --steps {steps}"
    assert policy.about["command"].removeprefix("puckpilot ") in (SHIPPED / "champion.md").read_text()
    assert policy.network.sizes[1:-1] == preset.hidden
    with (SHIPPED / f"{file}.csv").open(newline="") as lines:
        curve = list(csv.DictReader(lines))
    assert int(curve[-1]["steps"]) == steps
    assert float(curve[-1]["seconds"]) / 3600.0 == pytest.approx(policy.about["hours"], abs=0.01)


def test_a_mean_policy_has_the_mean_of_each_weight() -> None:
    parts = [load_policy(SHIPPED / f"champion.finish_{name}.npz") for name in ("goalie", "veteran")]
    mean = mean_policy(parts, [0.55, 0.45], {})
    for k, weights in enumerate(mean.network.weights):
        by_hand = 0.55 * parts[0].network.weights[k].astype(float) + 0.45 * parts[1].network.weights[k].astype(float)
        np.testing.assert_allclose(weights, by_hand, atol=1e-6)


def test_policies_of_different_networks_have_no_mean() -> None:
    policy, other = (load_policy(SHIPPED / f"champion{name}.npz") for name in ("", ".match-randomized-v0"))
    with pytest.raises(ValueError, match="differ in layers, columns or scaling"):
        mean_policy([policy, other], [0.5, 0.5], {})
    with pytest.raises(ValueError, match=r"add up to 0\.9; expected 2 that add up to 1"):
        mean_policy([policy, policy], [0.5, 0.4], {})


@pytest.mark.slow
@pytest.mark.parametrize(
    ("variant", "script"),
    [
        ("match-v0", "interceptor"),
        pytest.param("match-v0", "veteran", marks=pytest.mark.long),
        ("match-randomized-v0", "bank_shot"),
    ],
)
def test_it_wins_against_scripts(variant: str, script: str) -> None:
    """It wins 90 % and more; one that wins half of its games would win 16 of 20 once in 150 tries."""
    result = play(variant, "policy:champion", script, 20, 7)
    assert result.wins[0] >= 16


def test_it_beats_a_player_that_never_attacks() -> None:
    """It wins 95 % of its games against the goalie; the champion under earlier rules drew all."""
    result = play("match-v0", "policy:champion", "goalie", 20, 7)
    assert result.wins[0] >= 14


@pytest.mark.parametrize(
    ("variant", "script", "ending", "least"),
    [
        # 93 %; two thirds would do it once in 80 tries
        pytest.param("attack-v0", "veteran", "shot on goal", 41, marks=pytest.mark.long),
        ("attack-v0", "random", "shot on goal", 30),  # 76 %; 40 % would once in 280
        ("defence-v0", "goalie", "clear", 45),  # 97 %; three quarters would once in 140
        ("defence-randomized-v0", "goalie", "clear", 26),  # 68 %; a third would once in 200
    ],
)
def test_it_succeeds_in_the_drills(variant: str, script: str, ending: str, least: int) -> None:
    result = play(variant, "policy:champion", script, 100, 7)
    assert sum(ENDING_NAMES[code] == ending for code in result.endings[:50]) >= least
