"""The strongest: tries many actions in the physics and plays the best, straight or over a wall, past the opponent."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baselines.aim import DIRECT, OVER_LEFT, OVER_RIGHT
from baselines.player import Player, Seat
from baselines.rollout import STYLE
from baselines.search import choose
from baselines.sight import Seen

WAYS = tuple((way, share) for way in (DIRECT, OVER_RIGHT, OVER_LEFT) for share in (-0.8, 0.0, 0.8))
VARIATIONS = 24
SPREAD = (0.06, 0.06, 2.0, 2.0)  # of the first variations: m, m, V, V; the last are a quarter as wide
# What it values (see rollout.STYLE): tuned by games against itself, 40 for each change.
VALUES = {
    "asleep": 0.1, "speed": 0.01, "possession": 0.12, "lost": 0.04, "patience": 5.0, "forward": 0.12, "off": 0.12,
    "run_up": 0.12, "guard": 0.25, "early": 0.3,
}  # fmt: skip


class Veteran(Player):
    """Remembers its last action, so that a plan under way is one of those it weighs."""

    def __init__(self, seat: Seat) -> None:
        super().__init__(seat)
        draws = np.random.default_rng(seat.seed).normal(size=(VARIATIONS, 4))
        self._changes = draws * np.array(SPREAD) * np.linspace(1.0, 0.25, VARIATIONS)[:, None]
        self._ways = np.array(WAYS, np.float64)
        self._bounds = seat.action_bounds.astype(np.float64)
        self._style = np.zeros(1, STYLE)
        for name, value in VALUES.items():
            self._style[name] = value
        self._last = np.tile(self._bounds.mean(axis=0), (seat.tables, 1))

    def reset(self, mask: NDArray[np.bool_]) -> None:
        """See `Player.reset`."""
        self._last[mask] = self._bounds.mean(axis=0)

    def decide(self, seen: Seen) -> NDArray[np.float64]:
        """See `Player.decide`."""
        actions = np.zeros((len(seen.puck), 4))
        choose(
            seen.puck, seen.mallet, seen.opponent, seen.held, self._last, seen.gantry_scale, self.seat.nominal,
            self._style, self._bounds, self._ways, self._changes, actions,
        )  # fmt: skip
        self._last[:] = actions
        return actions
