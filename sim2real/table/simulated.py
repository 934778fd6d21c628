"""Games in the simulator with what is true of every table: what a table's own physics costs is what they differ by."""

from __future__ import annotations

from collections.abc import Mapping

from baselines.matches.match import MatchResult, play
from puckpilot_env.options.at_table import AT_TABLE


def play_simulated(
    variant: str, player: str, opponent: str, games: int, seed: int, effects: Mapping[str, float] | None = None
) -> MatchResult:
    """Games of a player at the robot's seat in the simulator, with `effects`, parameters by name. ValueError, in one
    line, for an unknown name."""
    return play(variant, player, opponent, games, seed, parameters={**AT_TABLE, **(effects or {})}, exchange=False)
