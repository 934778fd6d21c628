"""The search for discs of other friction."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.linear.rest import Rest
from sim2real.diagnose.regimes.sliding.forces.motion import Columns, Motion
from sim2real.diagnose.regimes.sliding.tuned import SLIDING

MOVES = (-1, 0, 1)  # steps to places nearby


def patch_laws(
    motion: Motion, columns: Columns, rests: Sequence[Rest], used: np.ndarray
) -> tuple[list[Law], np.ndarray]:
    """Search the friction discs that explain most of the `used` (n,) bool residuals beside each of the `rests`, one
    disc at a time. Returns the laws and their columns (n, k) for all residuals."""

    def gains(discs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        block = columns(_inside(motion, discs))
        return np.stack([rest.gains(block[used]) for rest in rests]), block / SLIDING.unit

    grid = _discs(motion.size)
    score = np.concatenate(
        [gains(grid[k : k + SLIDING.patch_chunk])[0] for k in range(0, len(grid), SLIDING.patch_chunk)], axis=1
    )
    offered = [_distinct(grid, of_rest) for of_rest in score]
    best = np.concatenate(offered)
    beside = np.repeat(np.arange(len(rests)), [len(discs) for discs in offered])
    for finer in range(1, SLIDING.patch_refinements + 1):
        for k, disc in enumerate(best):
            near = _near(disc, 0.5**finer)
            best[k] = near[np.argmax(gains(near)[0][beside[k]])]
    laws = [_patch(f"patch_extra@{k}", disc, len(grid)) for k, disc in enumerate(best)]
    return laws, gains(best)[1]


def _distinct(discs: np.ndarray, score: np.ndarray) -> np.ndarray:
    """The best few of the `discs` (k, 3) by their `score` (k,), none with its centre in another.

    A patch of more friction looks much like one of less wherever else the puck is, and both are tried.
    """
    kept: list[np.ndarray] = []
    for disc in discs[np.argsort(-score)]:
        if all(np.hypot(*(disc[:2] - one[:2])) > max(disc[2], one[2]) for one in kept):
            kept.append(disc)
        if len(kept) == SLIDING.patches_kept:
            break
    return np.array(kept)


def _near(disc: np.ndarray, share: float) -> np.ndarray:
    """The disc and its neighbours (k, 3), at steps of a `share` of the grid's steps."""
    x, y, radius = disc
    step = share * _spacing(radius)
    near = [
        (x + i * step, y + j * step, radius * (1.0 + SLIDING.patch_growth * share * k))
        for i in MOVES
        for j in MOVES
        for k in MOVES
    ]
    return np.array(near)


def _patch(column: str, disc: np.ndarray, searched: int) -> Law:
    """The law of a friction patch at a disc (3,), selected among `searched` discs."""
    x, y, radius = map(float, disc)
    start = {"patch_x": x, "patch_y": y, "patch_radius": radius}
    return Law("friction_patch", (column,), start=start, searched=searched)


def _discs(size: np.ndarray) -> np.ndarray:
    """Centres and radii (k, 3) [m] of discs that cover a table of `size` (2,) [m]; small discs are closer together."""
    found = []
    for radius in SLIDING.patch_radii:
        step = _spacing(radius)
        x = np.linspace(0.0, size[0], max(int(size[0] / step), 2) + 1)
        y = np.linspace(0.0, size[1], max(int(size[1] / step), 2) + 1)
        found.append(np.array([(a, b, radius) for a in x for b in y]))
    return np.concatenate(found)


def _spacing(radius: float) -> float:
    """Distance [m] of neighbouring discs of a radius [m]."""
    return max(SLIDING.patch_spacing * radius, SLIDING.least_patch_spacing)


def _inside(motion: Motion, discs: np.ndarray) -> np.ndarray:
    """Accelerations (n, 2, k) [m/s^2] of one unit of additional friction inside each disc (k, 3)."""
    x, y, radius = discs.T
    inside = np.subtract.outer(motion.place[:, 0], x) ** 2 + np.subtract.outer(motion.place[:, 1], y) ** 2 < radius**2
    return (-SLIDING.unit * motion.along)[:, :, None] * inside[:, None, :]
