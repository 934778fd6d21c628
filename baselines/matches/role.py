"""How the episodes of a drill ended for the player that was tested.

In a drill player_0 is tested, and player_1 is its opponent. A share of games won from both seats would be meaningless,
since a failed attack counts for one player and against the other. So a player's results are of the episodes in which it
was player_0, whose starts all differ.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from baselines.matches.match import MatchResult
from baselines.ratings.intervals import IntervalEstimate, share_estimate
from puckpilot_env.game.rules import CLEAR, CONCEDED, ENDING_NAMES, LOST, MISSED, SHOT, STEP_LIMIT
from puckpilot_env.game.start import ATTACK, DEFENCE, MATCH
from puckpilot_env.variants import Variant

JOBS = {DEFENCE: CLEAR, ATTACK: SHOT}  # the ending that the tested player should bring about
ENDINGS = {DEFENCE: (CLEAR, CONCEDED, LOST, STEP_LIMIT), ATTACK: (SHOT, CONCEDED, MISSED, STEP_LIMIT)}
OTHER_GOAL = "opponent conceded"  # a goal against the player that is not tested


@dataclass(frozen=True)
class Role:
    """How the episodes ended in which `player` was tested `against` another.

    `counts`: episodes by the name of their ending; `job`: the ending that the player should bring about.
    """

    player: str
    against: str
    job: str
    counts: Mapping[str, int]

    @property
    def episodes(self) -> int:
        """Number of episodes in which the player was tested."""
        return sum(self.counts.values())

    def share(self, ending: str) -> IntervalEstimate:
        """Share of the episodes with this ending, with its 95 % interval."""
        return share_estimate(self.counts[ending], self.episodes - self.counts[ending])

    def as_dict(self) -> dict[str, object]:
        """As JSON can hold it: counts and shares of all endings."""
        endings = {name: {"count": count, **self.share(name).as_dict()} for name, count in self.counts.items()}
        return {
            "tested": self.player, "against": self.against, "episodes": self.episodes, "job": self.job,
            "endings": endings,
        }  # fmt: skip


def role_of(variant: Variant, result: MatchResult, player: int = 0) -> Role | None:
    """How the episodes ended in which `player`, the first (0) or second (1) of `result`, was tested in this drill.

    None for a match, which tests nobody.
    """
    if variant.game == MATCH:
        return None
    pairs = len(result.results)
    codes = result.endings[:pairs] if player == 0 else result.endings[pairs:]
    won = (result.results[:, 0] if player == 0 else -result.results[:, 1])[: len(codes)]
    names = np.array(ENDING_NAMES, object)[codes]
    names[(codes == CONCEDED) & (won > 0.0)] = OTHER_GOAL
    listed = [*(ENDING_NAMES[code] for code in ENDINGS[variant.game]), OTHER_GOAL]
    found = names.tolist()
    counts = {name: found.count(name) for name in dict.fromkeys([*listed, *found])}
    return Role(result.players[player], result.players[1 - player], ENDING_NAMES[JOBS[variant.game]], counts)


def roles_of(variant: Variant, result: MatchResult) -> list[Role]:
    """The roles of both players, each tested against the other; empty for a match."""
    return [role for k in range(2) if (role := role_of(variant, result, k))]
