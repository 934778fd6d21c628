"""Games in the simulator with what is true of every table: what a table's own physics costs is what they differ by."""

from __future__ import annotations

from baselines.matches.match import MatchResult, play
from puckpilot_env.options.at_table import AT_TABLE


def play_simulated(variant: str, player: str, opponent: str, games: int, seed: int) -> MatchResult:
    """Games of a player at the robot's seat in the simulator. ValueError, in one line, for an unknown name."""
    return play(variant, player, opponent, games, seed, parameters=AT_TABLE, exchange=False)
