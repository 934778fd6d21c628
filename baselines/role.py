"""How well a player does its job in a drill, where the two seats have different ones.

In a drill player_0 is tested and player_1 is what it is tested against, so a share of games won from both seats says
little: a shot that is kept out by either player counts for one of them and against the other. What is told here comes
from the games in which the player sat in seat 0 alone, whose starts are all different.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baselines.intervals import Estimate, share_estimate
from baselines.match import MatchResult
from puckpilot_env.game.rules import CONCEDED, SHOT
from puckpilot_env.game.start import ATTACK, DEFENCE, MATCH
from puckpilot_env.variants import Variant

JOBS = {DEFENCE: "shots kept out", ATTACK: "attacks scored"}


@dataclass(frozen=True)
class Role:
    """`done` of `of` times player_0 did its `job`, and the `share` with its 95 % interval."""

    job: str
    done: int
    of: int
    share: Estimate

    def as_dict(self) -> dict[str, object]:
        return {"job": self.job, "done": self.done, "of": self.of, **self.share.as_dict()}


def role_of(variant: Variant, result: MatchResult) -> Role | None:
    """How the first of `result`'s players did in seat 0 of this drill; None of a match, which has no roles."""
    if variant.game == MATCH:
        return None
    won, endings = result.results[:, 0], result.endings[: len(result.results)]
    good = _kept_out(won, endings) if variant.game == DEFENCE else endings == SHOT
    done, of = int(good.sum()), len(good)
    return Role(JOBS[variant.game], done, of, share_estimate(done, of - done))


def _kept_out(won: NDArray[np.float64], endings: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Not conceded: possession may be lost, or time run out, and an attacker's goal into its own net is no miss."""
    return ~((endings == CONCEDED) & (won < 0.0))
