"""Who may play at a table: scripts, and policies of the game that is played, at its rate."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from baselines.player import Seat
from puckpilot_env.tables import Tables
from sim2real.table.game.seated_player import seated_player
from tests.agents.policy.some_policy import made


def trained(variant: str, folder: Path) -> str:
    """The file of a policy that says so."""
    policy = replace(made(variant), about={"variant": f"puckpilot/{variant}"})
    return str(policy.save(folder / "other.npz"))


def seat(period: float | None = None) -> Seat:
    return Seat.from_tables(Tables("match-v0", 1, period=period))


@pytest.mark.parametrize("variant", ["match-v0", "match-randomized-v0"])
def test_a_policy_of_this_game_is_seated(variant: str, tmp_path: Path) -> None:
    assert seated_player(trained(variant, tmp_path), seat()).made_for == f"puckpilot/{variant}"


@pytest.mark.parametrize("variant", ["defence-v0", "attack-v0"])
def test_a_policy_of_another_game_is_refused(variant: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=rf"trained for puckpilot/{variant}; here puckpilot/match-v0 is played; "):
        seated_player(trained(variant, tmp_path), seat())


def test_a_policy_of_another_rate_is_refused_and_a_script_is_not() -> None:
    with pytest.raises(ValueError, match=r"a decision every 0.1 s; here .* is played, a decision every 0.05 s; choose"):
        seated_player("policy:champion", seat(0.05))
    assert seated_player("interceptor", seat(0.05)).seat.period == 0.05
