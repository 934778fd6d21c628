"""The shipped player: it says what made it, and it wins."""

from __future__ import annotations

import csv

import pytest

from agents.policy import SHIPPED, find_policy
from agents.preset import find_preset
from baselines.match import play


def test_it_says_what_made_it_and_its_curve_ends_there() -> None:
    policy, preset = find_policy("champion"), find_preset("champion")
    steps = policy.about["steps"]
    assert policy.about["command"] == f"puckpilot train --preset champion --seed {policy.about['seed']} --steps {steps}"
    assert policy.network.sizes[1:-1] == preset.hidden
    with (SHIPPED / "champion.csv").open(newline="") as file:
        curve = list(csv.DictReader(file))
    assert int(curve[-1]["steps"]) == steps
    assert float(curve[-1]["seconds"]) / 3600.0 == pytest.approx(policy.about["hours"], abs=0.01)


@pytest.mark.parametrize("script", ["interceptor", "veteran"])
def test_it_wins(script: str) -> None:
    """It wins 97 % and more; one that wins half of its games would win 17 of 20 once in 500 tries."""
    result = play("match-v0", "policy:champion", script, 20, 7)
    assert result.wins[0] >= 17
