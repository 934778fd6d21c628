"""The strongest script: simulates many actions and plays the best, straight or off a wall, past the opponent."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baselines.observation_decoder import DecodedState
from baselines.planning.aim import BANK_LEFT, BANK_RIGHT, DIRECT
from baselines.planning.rollout import VALUE_WEIGHTS
from baselines.planning.search import SCENE, search_actions
from baselines.player import Player, Seat

SHOTS = tuple((path, share) for path in (DIRECT, BANK_RIGHT, BANK_LEFT) for share in (-0.8, 0.0, 0.8))
VARIATIONS = 24
SPREAD = (0.06, 0.06, 2.0, 2.0)  # standard deviation of the first variations: m, m, V, V; that of the last is a quarter
# Tuned by games against itself, 40 for each change; see `rollout.VALUE_WEIGHTS`.
WEIGHTS = {
    "asleep": 0.1, "speed": 0.01, "possession": 0.12, "lost": 0.04, "patience": 5.0, "forward": 0.12, "off": 0.12,
    "run_up": 0.12, "guard": 0.25, "early": 0.3,
}  # fmt: skip


class Veteran(Player):
    """Keeps its last action, so that the plan under way is among its candidates."""

    def __init__(self, seat: Seat) -> None:
        super().__init__(seat)
        draws = np.random.default_rng(seat.seed).normal(size=(VARIATIONS, 4))
        self._variations = draws * np.array(SPREAD) * np.linspace(1.0, 0.25, VARIATIONS)[:, None]
        self._shots = np.array(SHOTS, np.float64)
        self._bounds = seat.action_bounds.astype(np.float64)
        self._weights = np.zeros(1, VALUE_WEIGHTS)
        for name, value in WEIGHTS.items():
            self._weights[name] = value
        self._last = np.tile(self._bounds.mean(axis=0), (seat.tables, 1))

    def reset(self, mask: NDArray[np.bool_]) -> None:
        """See `Player.reset`."""
        self._last[mask] = self._bounds.mean(axis=0)

    def decide(self, state: DecodedState) -> NDArray[np.float64]:
        """See `Player.decide`."""
        actions = np.zeros((len(state.puck), 4))
        search_actions(
            state.puck, state.mallet, state.opponent, state.held, self._last, state.gantry_scale, self.seat.nominal,
            self._weights, self._bounds, self._shots, self._variations, np.zeros(1, SCENE), actions,
        )  # fmt: skip
        self._last[:] = actions
        return actions
