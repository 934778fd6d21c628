"""Who the learner plays besides itself: its earlier selves, and fixed anchors (scripts, specialists).

Who still wins is met more often: an opponent that always loses teaches nothing (prioritized fictitious self-play,
Vinyals et al., Nature 575, 2019). Anchors have a few tables of their own besides, to measure the learner by.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from agents.policy import Policy
from baselines.payoff import Payoff
from baselines.rating import fit_ratings

FORGET = 0.8  # what a tally keeps from one round to the next
DOUBT = 2.0  # points that a member is taken to have won, and lost, before it played
LEAST_CHANCE = 0.01  # weight of one that never wins, so that it is still met now and then


@dataclass(eq=False)
class Member:
    """An opponent: a script's name, or a policy. `points`: the learner's and its own, of late; `games`: likewise
    games that the learner won, drew and lost. `beside`: the variant beside the run's own that it is met in, if so."""

    name: str
    policy: Policy | None = None
    beside: str = ""
    points: NDArray[np.float64] = field(default_factory=lambda: np.zeros(2))
    games: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))

    @property
    def label(self) -> str:
        """How it is called among all anchors."""
        return f"{self.name}@{self.beside}" if self.beside else self.name

    @property
    def share(self) -> float:
        """Share of the points that the learner wins against it, 0 to 1."""
        return float((self.points[0] + DOUBT) / (self.points.sum() + 2.0 * DOUBT))

    @property
    def win_rate(self) -> float:
        """Share of the decided games of late that the learner won; NaN where there are none."""
        decided = self.games[0] + self.games[2]
        return float(self.games[0] / decided) if decided else float("nan")

    def note(self, points: NDArray[np.float64], games: NDArray[np.float64]) -> None:
        """Add a round's points (2,) and games (3,)."""
        self.points = FORGET * self.points + points
        self.games = FORGET * self.games + games


@dataclass
class League:
    """`anchors` always sit; of `earlier` selves some do. A new self is admitted once the learner wins `gate` of the
    points against those that it met, or after `cap` rounds."""

    anchors: list[Member]
    gate: float
    cap: int
    most: int
    earlier: list[Member] = field(default_factory=list)
    waited: int = 0

    def choose(self, seats: int, rng: np.random.Generator, beside: str = "") -> list[Member]:
        """Who sits at `seats` blocks in a round, some perhaps at two: half of them earlier selves, on average. The
        others are anchors of the run's own variant, or of the one `beside` it."""
        groups = [some for some in (self.earlier, self.of(beside)) if some]
        odds = [np.array([max((1.0 - one.share) ** 2, LEAST_CHANCE) for one in some]) for some in groups]
        chances = np.concatenate([weights / weights.sum() / len(groups) for weights in odds])
        members = [one for some in groups for one in some]
        return [members[index] for index in rng.choice(len(members), size=seats, p=chances)]

    def of(self, beside: str) -> list[Member]:
        """The anchors of the run's own variant, for "", or of one beside it."""
        return [member for member in self.anchors if member.beside == beside]

    def rating(self) -> float:
        """Elo of the learner among the anchors of its own variant, by the games of late; the mean of all is 0."""
        met = [member for member in self.of("") if member.games.sum() > 0.0]
        if not met:
            return 0.0
        wins, draws = np.zeros((2, 1 + len(met), 1 + len(met)))
        for k, member in enumerate(met, start=1):
            wins[0, k], draws[0, k], wins[k, 0] = member.games
        names = ("learner", *(member.name for member in met))
        return fit_ratings(Payoff(names, wins, draws + draws.T)).elo[0]

    def wants_new(self, met: list[Member]) -> bool:
        """Whether the learner, having `met` these, should join its earlier selves."""
        self.waited += 1
        shares = [member.share for member in met if member in self.earlier]
        return self.waited >= self.cap or (bool(shares) and min(shares) >= self.gate)

    def admit(self, name: str, policy: Policy) -> None:
        """A new self joins; of too many the one that loses most leaves."""
        self.earlier.append(Member(name, policy))
        self.waited = 0
        if len(self.earlier) > self.most:
            self.earlier.remove(max(self.earlier[:-1], key=lambda member: member.share))
