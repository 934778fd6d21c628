"""The opponent pool: snapshots of the learner from earlier in training, and fixed anchors (scripts, other policies).

Opponents that still win are drawn more often, since one that always loses teaches nothing (prioritized fictitious
self-play; Vinyals and others, "Grandmaster level in StarCraft II", Nature 575, 2019). Every anchor also has some tables
of its own in every round, by which the learner's progress is measured.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from agents.policy.policy import Policy
from baselines.matches.payoff import Payoff
from baselines.ratings.rating import fit_ratings

DECAY = 0.8  # factor on a member's earlier results when a new round's are added
PRIOR_POINTS = 2.0  # points that each side is taken to have won before the first game
LEAST_WEIGHT = 0.01  # of a member that never wins, so that it is still drawn now and then


@dataclass(eq=False)
class Member:
    """An opponent in the league, with its recent results against the learner.

    - `name`: a script's name or a snapshot's; `policy`: the snapshot's policy, None for an anchor.
    - `extra_variant`: the variant at which an anchor is played, "" for the run's own variant.
    - `points` (2,): points of the learner and of the member, older rounds discounted by DECAY.
    - `games` (3,): games that the learner won, drew and lost, discounted likewise.
    """

    name: str
    policy: Policy | None = None
    extra_variant: str = ""
    points: NDArray[np.float64] = field(default_factory=lambda: np.zeros(2))
    games: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))

    @property
    def label(self) -> str:
        """A name that is unique among all anchors: NAME, or NAME@VARIANT."""
        return f"{self.name}@{self.extra_variant}" if self.extra_variant else self.name

    @property
    def point_share(self) -> float:
        """Share of the points that the learner wins against it, 0 to 1."""
        return float((self.points[0] + PRIOR_POINTS) / (self.points.sum() + 2.0 * PRIOR_POINTS))

    @property
    def win_rate(self) -> float:
        """Share of the decisive games that the learner won; NaN where no game was decisive."""
        decisive = self.games[0] + self.games[2]
        return float(self.games[0] / decisive) if decisive else float("nan")

    def add_results(self, points: NDArray[np.float64], games: NDArray[np.float64]) -> None:
        """Add a round's `points` (2,) and `games` (3,)."""
        self.points = DECAY * self.points + points
        self.games = DECAY * self.games + games


@dataclass
class League:
    """The anchors, which play in every round, and the snapshots of the learner, of which some do.

    The learner joins as a new snapshot once it wins `snapshot_threshold` (0 to 1) of the points against each snapshot
    of a round, or `max_rounds` rounds after the last one joined. At most `max_snapshots` are kept.
    `rounds_since_snapshot` counts the rounds since.
    """

    anchors: list[Member]
    snapshot_threshold: float
    max_rounds: int
    max_snapshots: int
    snapshots: list[Member] = field(default_factory=list)
    rounds_since_snapshot: int = 0

    def sample_opponents(self, count: int, rng: np.random.Generator, extra_variant: str = "") -> list[Member]:
        """Draw `count` opponents for a round, with replacement.

        On average half of them are snapshots, the others anchors of the variant. Within each half a member's weight is
        (1 - point_share)^2, at least LEAST_WEIGHT.
        """
        groups = [some for some in (self.snapshots, self.anchors_of(extra_variant)) if some]
        weights = [np.array([max((1.0 - one.point_share) ** 2, LEAST_WEIGHT) for one in some]) for some in groups]
        chances = np.concatenate([some / some.sum() / len(groups) for some in weights])
        members = [one for some in groups for one in some]
        return [members[index] for index in rng.choice(len(members), size=count, p=chances)]

    def anchors_of(self, extra_variant: str) -> list[Member]:
        """The anchors that play at an extra variant, or with "" at the run's own."""
        return [member for member in self.anchors if member.extra_variant == extra_variant]

    def rating(self) -> float:
        """Elo rating of the learner among the anchors of its own variant, whose common mean is 0; 0 without games."""
        played = [member for member in self.anchors_of("") if member.games.sum() > 0.0]
        if not played:
            return 0.0
        wins, draws = np.zeros((2, 1 + len(played), 1 + len(played)))
        for k, member in enumerate(played, start=1):
            wins[0, k], draws[0, k], wins[k, 0] = member.games
        names = ("learner", *(member.name for member in played))
        return fit_ratings(Payoff(names, wins, draws + draws.T)).elo[0]

    def should_snapshot(self, opponents: list[Member]) -> bool:
        """Whether the learner, having played a round against `opponents`, should join the pool.

        Call it once a round.
        """
        self.rounds_since_snapshot += 1
        shares = [member.point_share for member in opponents if member in self.snapshots]
        return self.rounds_since_snapshot >= self.max_rounds or (
            bool(shares) and min(shares) >= self.snapshot_threshold
        )

    def add_snapshot(self, name: str, policy: Policy) -> None:
        """Add a snapshot. If there are too many, the older one against which the learner wins most is removed."""
        self.snapshots.append(Member(name, policy))
        self.rounds_since_snapshot = 0
        if len(self.snapshots) > self.max_snapshots:
            self.snapshots.remove(max(self.snapshots[:-1], key=lambda member: member.point_share))
