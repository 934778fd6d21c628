"""How the episodes of a drill ended for the player that was tested.

In a drill player_0 is tested and player_1 is what it is tested against, so a share of games won from both seats says
nothing: an attack that fails counts for one of them and against the other. What is told here comes from the episodes in
which a player sat in seat 0 alone, whose starts are all different; of two players' meeting, from each one's own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from baselines.intervals import Estimate, share_estimate
from baselines.match import MatchResult
from puckpilot_env.game.rules import CLEAR, CONCEDED, ENDING_NAMES, LOST, MISSED, SHOT, STEP_LIMIT
from puckpilot_env.game.start import ATTACK, DEFENCE, MATCH
from puckpilot_env.variants import Variant

JOBS = {DEFENCE: CLEAR, ATTACK: SHOT}  # the ending that is the tested player's job
ENDINGS = {DEFENCE: (CLEAR, CONCEDED, LOST, STEP_LIMIT), ATTACK: (SHOT, CONCEDED, MISSED, STEP_LIMIT)}
OTHER_GOAL = "opponent conceded"  # a goal against the player that is not tested


@dataclass(frozen=True)
class Role:
    """How often each ending came in the episodes in which `player` was tested against another; `job` is one of them."""

    player: str
    against: str
    job: str
    counts: Mapping[str, int]

    @property
    def episodes(self) -> int:
        """In which the player was tested."""
        return sum(self.counts.values())

    def share(self, ending: str) -> Estimate:
        """Share of its episodes that ended so, with its 95 % interval."""
        return share_estimate(self.counts[ending], self.episodes - self.counts[ending])

    def as_dict(self) -> dict[str, object]:
        endings = {name: {"count": count, **self.share(name).as_dict()} for name, count in self.counts.items()}
        return {
            "tested": self.player, "against": self.against, "episodes": self.episodes, "job": self.job,
            "endings": endings,
        }  # fmt: skip


def role_of(variant: Variant, result: MatchResult, player: int = 0) -> Role | None:
    """How the episodes ended in which the first (0) or the second (1) of `result`'s players was tested in this drill;
    None of a match, which tests nobody."""
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
    """Of both players, each tested against the other; empty of a match."""
    return [role for k in range(2) if (role := role_of(variant, result, k))]
