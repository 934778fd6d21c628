"""From an observation of any variant to puck and mallets *now*, by the columns' names: the one place that knows how.

Where puck velocities are given they are taken; where only measured places are given (`puck_0_x`, `puck_1_x`, ...) they
are differences. A camera shows the past: what it saw is moved on by its nominal delay, walls and friction included.
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


@dataclass(frozen=True)
class Seen:
    """`n` tables as a player sees them, in its own frame; motions are (n, 4) float64: x, y [m], vx, vy [m/s]."""

    puck: NDArray[np.float64]
    mallet: NDArray[np.float64]
    opponent: NDArray[np.float64]
    gantry_scale: NDArray[np.float64]  # (n, 2, 3): own C5, C6, C7 of axes x, y relative to the nominal
    held: NDArray[np.float64]  # (n,) s since the puck last changed halves; 0 where that is not told


class Sight:
    """Reads observations with these `columns` (index by name) and nominal parameters (a (1,) record)."""

    def __init__(self, columns: dict[str, int], nominal: NDArray[np.void]) -> None:
        self._columns = columns
        self._nominal = nominal
        self._rate = float(nominal["frame_rate"][0])
        self._lags = sorted(int(m[1]) for m in (re.fullmatch(r"puck_(\d+)_x", name) for name in columns) if m)
        measured = bool(self._lags) or "seen" in columns
        self._delay = float(mean_delay(nominal[0])) if measured else 0.0

    def read(self, observation: NDArray[np.float32]) -> Seen:
        """What an observation (n, d) shows."""
        seen = np.asarray(observation, np.float64)
        if self._lags:
            puck, opponent = self._from_history(seen)
        else:
            puck, opponent = self._motion(seen, "puck"), self._motion(seen, "opponent")
        if self._delay > 0.0:
            _move_on(puck, self._nominal, np.full(len(puck), self._delay))
            opponent[:, :2] += self._delay * opponent[:, 2:]
        scale = np.ones((len(seen), 2, 3))
        if "gantry_c5_x" in self._columns:
            for a, axis in enumerate("xy"):
                for c in range(3):
                    scale[:, a, c] = seen[:, self._columns[f"gantry_c{c + 5}_{axis}"]]
        held = seen[:, self._columns["held"]] if "held" in self._columns else np.zeros(len(seen))
        return Seen(puck, self._motion(seen, "mallet"), opponent, scale, held)

    def _motion(self, seen: NDArray[np.float64], what: str) -> NDArray[np.float64]:
        return seen[:, [self._columns[what + suffix] for suffix in MOTION]]

    def _from_history(self, seen: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Puck and opponent motions (n, 4) at the newest frame, from the places measured at several lags."""
        lags = np.array(self._lags)

        def places(what: str) -> NDArray[np.float64]:
            return np.stack([seen[:, [self._columns[f"{what}_{lag}_{a}"] for a in "xy"]] for lag in lags], axis=1)

        puck, opponent = places("puck"), places("opponent")
        fresh = np.stack([seen[:, self._columns[f"seen_{lag}"]] > 0.5 for lag in lags], axis=1)
        fresh[:, :-1] &= (puck[:, :-1] != puck[:, 1:]).any(axis=2)  # a frame that repeats the one before is not news
        rows = np.arange(len(seen))
        new = fresh.argmax(axis=1)  # newest fresh frame
        gap = lags[None, :] - lags[new][:, None]
        good = fresh & (gap >= 1)
        old = np.where(good & (gap >= 2), gap, np.where(good, 100 + gap, 1000)).argmin(axis=1)
        both = good[rows, old]
        apart = np.where(both, gap[rows, old], 1) / self._rate
        velocity = np.where(both[:, None], (puck[rows, new] - puck[rows, old]) / apart[:, None], 0.0)
        motion = np.concatenate([puck[rows, new], velocity], axis=1)
        _move_on(motion, self._nominal, lags[new] / self._rate)
        span = (lags[2] - lags[0]) / self._rate
        return motion, np.concatenate([opponent[:, 0], (opponent[:, 0] - opponent[:, 2]) / span], axis=1)


@kernel
def _move_on(motions, nominal, durations):
    """Let every puck of `motions` (n, 4) glide on for `durations` (n,) [s]."""
    p = nominal[0]
    for i in range(motions.shape[0]):
        x = min(max(motions[i, 0], p.puck_radius), p.length - p.puck_radius)
        y = min(max(motions[i, 1], p.puck_radius), p.width - p.puck_radius)
        x, y, vx, vy = expected_place(x, y, motions[i, 2], motions[i, 3], p, durations[i])
        motions[i, 0], motions[i, 1], motions[i, 2], motions[i, 3] = x, y, vx, vy
