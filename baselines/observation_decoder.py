"""Decodes an observation of any variant into present positions and velocities of puck and mallets, by column names.

Where an observation has the puck's velocity, it is used. Where it has only measured positions (`puck_0_x`, `puck_1_x`,
...), velocities are finite differences of them. A camera shows the past: what it measured is propagated by its nominal
delay, with walls and friction. No other place in the product interprets observations.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from puckpilot_env.game.predict import expected_place
from puckpilot_env.game.sensing import mean_delay
from puckpilot_env.kernel import kernel

MOTION = ("_x", "_y", "_vx", "_vy")
SECOND_CHOICE, UNUSABLE = 100, 1000  # ranks of frames, worse than any gap; see `_velocity_frame`


@dataclass(frozen=True)
class DecodedState:
    """The state of n tables in the player's own frame. Motions are (n, 4) float64: x, y [m] and vx, vy [m/s].

    - `puck`, `mallet` (the player's own), `opponent`: motions.
    - `gantry_scale` (n, 2, 3): the own gantry's parameters C5, C6, C7 of axes x, y relative to the nominal ones.
    - `held` (n,): time [s] since the puck last changed halves; 0 where the observation does not have it.
    """

    puck: NDArray[np.float64]
    mallet: NDArray[np.float64]
    opponent: NDArray[np.float64]
    gantry_scale: NDArray[np.float64]
    held: NDArray[np.float64]


class ObservationDecoder:
    """Decodes observations with given `columns` (index by name) at tables of `nominal` parameters (a (1,) record)."""

    def __init__(self, columns: dict[str, int], nominal: NDArray[np.void]) -> None:
        self._columns = columns
        self._nominal = nominal
        self._rate = float(nominal["frame_rate"][0])
        self._lags = sorted(int(m[1]) for m in (re.fullmatch(r"puck_(\d+)_x", name) for name in columns) if m)
        measured = bool(self._lags) or "seen" in columns
        self._delay = float(mean_delay(nominal[0])) if measured else 0.0

    def decode(self, observation: NDArray[np.float32]) -> DecodedState:
        """The present state of n tables from their observations (n, d)."""
        numbers = np.asarray(observation, np.float64)
        if self._lags:
            puck, opponent = self._from_history(numbers)
        else:
            puck, opponent = self._motion(numbers, "puck"), self._motion(numbers, "opponent")
        if self._delay > 0.0:
            _propagate(puck, self._nominal, np.full(len(puck), self._delay))
            opponent[:, :2] += self._delay * opponent[:, 2:]
        scale = np.ones((len(numbers), 2, 3))
        if "gantry_c5_x" in self._columns:
            for a, axis in enumerate("xy"):
                for c in range(3):
                    scale[:, a, c] = numbers[:, self._columns[f"gantry_c{c + 5}_{axis}"]]
        held = numbers[:, self._columns["held"]] if "held" in self._columns else np.zeros(len(numbers))
        state = (puck, self._motion(numbers, "mallet"), opponent, scale, held)
        return DecodedState(*map(np.ascontiguousarray, state))  # kernels compile anew for every memory layout

    def _motion(self, numbers: NDArray[np.float64], what: str) -> NDArray[np.float64]:
        """(n, 4) motion of "puck", "mallet" or "opponent"."""
        return numbers[:, [self._columns[what + suffix] for suffix in MOTION]]

    def _positions(self, numbers: NDArray[np.float64], what: str) -> NDArray[np.float64]:
        """(n, lags, 2) measured positions, the newest frame first."""
        columns = [[self._columns[f"{what}_{lag}_{axis}"] for axis in "xy"] for lag in self._lags]
        return np.stack([numbers[:, pair] for pair in columns], axis=1)

    def _from_history(self, numbers: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Motions (n, 4) of puck and opponent at the newest frame, from the positions measured at several lags."""
        lags, rows = np.array(self._lags), np.arange(len(numbers))
        puck, opponent = self._positions(numbers, "puck"), self._positions(numbers, "opponent")
        fresh = np.stack([numbers[:, self._columns[f"seen_{lag}"]] > 0.5 for lag in lags], axis=1)
        fresh[:, :-1] &= (puck[:, :-1] != puck[:, 1:]).any(axis=2)  # a frame that repeats the one before is not fresh
        new = fresh.argmax(axis=1)  # newest fresh frame
        gap = lags[None, :] - lags[new][:, None]
        old, known = _velocity_frame(fresh, gap)
        dt = np.where(known, gap[rows, old], 1) / self._rate
        velocity = np.where(known[:, None], (puck[rows, new] - puck[rows, old]) / dt[:, None], 0.0)
        motion = np.concatenate([puck[rows, new], velocity], axis=1)
        _propagate(motion, self._nominal, lags[new] / self._rate)
        span = (lags[2] - lags[0]) / self._rate
        return motion, np.concatenate([opponent[:, 0], (opponent[:, 0] - opponent[:, 2]) / span], axis=1)


def _velocity_frame(fresh: NDArray[np.bool_], gap: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """For each row the older frame of the difference that gives the velocity, and whether there is one.

    `fresh` and `gap` are (n, lags), the gap in frames from the newest fresh frame. The nearest fresh frame at a gap of
    two or more is best; a gap of one is the second choice.
    """
    usable = fresh & (gap >= 1)
    rank = np.where(usable & (gap >= 2), gap, np.where(usable, SECOND_CHOICE + gap, UNUSABLE))
    old = rank.argmin(axis=1)
    return old, usable[np.arange(len(fresh)), old]


@kernel
def _propagate(motions, nominal, durations):
    """Let every puck of `motions` (n, 4) slide on for `durations` (n,) [s], in place."""
    p = nominal[0]
    for i in range(motions.shape[0]):
        x = min(max(motions[i, 0], p.puck_radius), p.length - p.puck_radius)
        y = min(max(motions[i, 1], p.puck_radius), p.width - p.puck_radius)
        x, y, vx, vy = expected_place(x, y, motions[i, 2], motions[i, 3], p, durations[i])
        motions[i, 0], motions[i, 1], motions[i, 2], motions[i, 3] = x, y, vx, vy
