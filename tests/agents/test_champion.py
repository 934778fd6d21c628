"""The shipped player: it says what made it, and it wins."""

from __future__ import annotations

import csv

import pytest

from agents.policy import SHIPPED, load_policy
from agents.preset import find_preset
from baselines.match import play
from puckpilot_env.game.rules import ENDING_NAMES


@pytest.mark.parametrize(
    ("file", "words"),
    [
        ("champion", "--preset champion"),
        ("champion.match-randomized-v0", "--preset randomized --variant match-randomized-v0 --start champion"),
        ("champion.attack-v0", "--preset attack --variant attack-v0 --start champion"),
    ],
)
def test_it_says_what_made_it_and_its_curve_ends_there(file: str, words: str) -> None:
    policy, preset = load_policy(SHIPPED / f"{file}.npz"), find_preset(words.split()[1])
    steps = policy.about["steps"]
    assert policy.about["command"] == f"puckpilot train {words} --seed {policy.about['seed']} --steps {steps}"
    assert policy.about["command"].removeprefix("puckpilot ") in (SHIPPED / "champion.md").read_text()
    assert policy.network.sizes[1:-1] == preset.hidden
    with (SHIPPED / f"{file}.csv").open(newline="") as lines:
        curve = list(csv.DictReader(lines))
    assert int(curve[-1]["steps"]) == steps
    assert float(curve[-1]["seconds"]) / 3600.0 == pytest.approx(policy.about["hours"], abs=0.01)


@pytest.mark.parametrize(
    ("variant", "script"), [("match-v0", "interceptor"), ("match-v0", "veteran"), ("match-randomized-v0", "bank_shot")]
)
def test_it_wins(variant: str, script: str) -> None:
    """It wins 90 % and more; one that wins half of its games would win 16 of 20 once in 150 tries."""
    result = play(variant, "policy:champion", script, 20, 7)
    assert result.wins[0] >= 16


def test_it_scores_in_the_drill() -> None:
    """Against the strongest defence 70 % of attacks; one that scores a fifth would score 20 of 50 once in 1,000."""
    result = play("attack-v0", "policy:champion", "veteran", 100, 7)
    assert sum(ENDING_NAMES[ending] == "shot on goal" for ending in result.endings[:50]) >= 20
