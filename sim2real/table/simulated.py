"""What is true of every table, as the simulator is given it, and games there: what a table's own physics costs is what
they differ by.

The loop's own delay is not among it, since players are shown what will be when they act.
"""

from __future__ import annotations

from collections.abc import Mapping

from baselines.matches.match import MatchResult, play
from sim2real.table.mallet_driver import BRAKING_TIME, OPERATING_VOLTS

LOOP: Mapping[str, float] = {"max_voltage": OPERATING_VOLTS, "braking_time": BRAKING_TIME, "hand": 1.0}


def play_simulated(variant: str, player: str, opponent: str, games: int, seed: int) -> MatchResult:
    """Games of a player at the robot's seat in the simulator. ValueError, in one line, for an unknown name."""
    return play(variant, player, opponent, games, seed, parameters=LOOP, exchange=False)
