"""A player's evaluation on a task of the protocol: games against each opponent, as rows that JSON can hold.

`score` is what is compared: of a match the share of points, a draw counting half of one; of a drill the share of
episodes that ended with the job done.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any

from agents.benchmark.protocol import Protocol, Task
from baselines.matches.match import Contestant, MatchResult, play
from baselines.matches.role import role_of
from puckpilot_env.variants import find_variant


@dataclass(frozen=True)
class Against:
    """How a player fared against an opponent. won: games, or episodes with the job done; lost: games, or episodes in
    which it conceded; goals: of both, in a drill those that ended an episode."""

    opponent: str
    games: int
    won: int
    lost: int
    goals: tuple[int, int]
    is_match: bool

    @property
    def score(self) -> float:
        """Share of points, or of jobs done."""
        drawn = self.games - self.won - self.lost if self.is_match else 0
        return (self.won + 0.5 * drawn) / self.games

    def as_dict(self) -> dict[str, Any]:
        """As JSON can hold it."""
        return {**asdict(self), "goals": list(self.goals), "score": self.score}


def evaluate(player: Contestant, task: Task, opponents: Iterable[str], games: int, seed: int) -> list[Against]:
    """Play `games`, of a match half from either seat, against each of the opponents. ValueError, in one line, for a
    player that cannot play."""
    rows = []
    for opponent in opponents:
        result = play(task.variant, player, opponent, games, seed, exchange=task.is_match)
        rows.append(_of_match(opponent, result) if task.is_match else _of_drill(task, opponent, result))
    return rows


def evaluate_by(protocol: Protocol, player: Contestant, task: Task) -> list[Against]:
    """The protocol's evaluation."""
    return evaluate(player, task, protocol.evaluated_against(task), protocol.games, protocol.evaluation_seed)


def mean_score(rows: Iterable[Against]) -> float:
    """The mean over opponents, each counting alike."""
    scores = [row.score for row in rows]
    return sum(scores) / len(scores)


def _of_match(opponent: str, result: MatchResult) -> Against:
    return Against(opponent, result.games, *result.wins, result.goals, is_match=True)


def _of_drill(task: Task, opponent: str, result: MatchResult) -> Against:
    role = role_of(find_variant(task.variant), result)
    assert role is not None
    return Against(opponent, result.games, role.counts[role.job], role.counts["conceded"], result.goals, is_match=False)
