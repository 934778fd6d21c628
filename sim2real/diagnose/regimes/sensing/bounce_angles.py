"""The angles by which a sheared or turned map deflects bounces, from the velocities along the walls.

A wall changes the velocity along it by a law that is odd in that velocity, whatever its friction: it slows, or does
not. A map that is sheared or turned adds a share of the change of the velocity across, whichever way the puck goes.
The long walls are met in any recording, the short ones may not be, and the long walls alone tell a shear.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

from sim2real.diagnose.regimes.sensing.contact_lines import ContactLine
from sim2real.diagnose.regimes.sensing.tuned import BOUNCE_ANGLES
from sim2real.segmentation.causes import wall_axis
from sim2real.segmentation.velocity_jumps import VelocityJump
from sim2real.statistics.robust import t_weights, typical

PAIRS = (("y0", "y1"), ("x0", "x1"))
ROUNDS = 20  # of reweighting


@dataclass(frozen=True)
class BounceAngles:
    """By how much bounces off `walls` are deflected: `values` (k,) [rad] with `covariance` (k, k).

    For each of the bounces: number (n,) of its `wall` in `walls`; `deflected` (n,) [m/s]: its change of the velocity
    along the wall beside friction, with standard deviation `std` (n,) [m/s]; `change` (n,) [m/s] of the velocity
    across; `launch` (n,).
    """

    walls: tuple[str, ...]
    values: np.ndarray
    covariance: np.ndarray
    wall: np.ndarray
    deflected: np.ndarray
    std: np.ndarray
    change: np.ndarray
    launch: np.ndarray

    def of_pairs(self, kept: Sequence[int]) -> BounceAngles:
        """The angles of the walls with the numbers `kept`, in that order."""
        here = np.isin(self.wall, kept)
        each = (self.deflected, self.std, self.change, self.launch)
        return BounceAngles(
            tuple(self.walls[k] for k in kept),
            self.values[list(kept)],
            self.covariance[np.ix_(kept, kept)],
            np.searchsorted(kept, self.wall[here]),
            *(one[here] for one in each),
        )


def bounce_angles(lines: Mapping[str, ContactLine]) -> BounceAngles:
    """Estimate the angles of those pairs of opposite walls in `lines` that agree.

    Walls that deflect bounces differently are turned themselves, and one wall alone does not tell itself from a map.
    """
    walls = tuple(wall for pair in PAIRS if all(_often_met(lines, wall) for wall in pair) for wall in pair)
    found = _fitted(lines, walls)
    return found.of_pairs([k for k in range(len(walls)) if _alike(found, k - k % 2)])


def _often_met(lines: Mapping[str, ContactLine], wall: str) -> bool:
    return wall in lines and len(lines[wall].jumps) >= BOUNCE_ANGLES.fewest_bounces


def _alike(found: BounceAngles, first: int) -> bool:
    """Whether the walls `first` and the next deflect bounces by the same angle."""
    pair = slice(first, first + 2)
    apart = np.array([1.0, -1.0])
    variance = apart @ found.covariance[pair, pair] @ apart + 2 * BOUNCE_ANGLES.wall_std**2
    return bool(2 * stats.norm.sf(abs(apart @ found.values[pair]) / np.sqrt(variance)) > BOUNCE_ANGLES.alike)


def _fitted(lines: Mapping[str, ContactLine], walls: Sequence[str]) -> BounceAngles:
    """Fit the angles of `walls` together with a law of friction."""
    rows = [_row(number, wall, jump) for number, wall in enumerate(walls) for jump in lines[wall].jumps]
    wall, moved, std, before, change, launch = np.array(rows).reshape(-1, 6).T
    slip = np.abs(change) * np.tanh(before / BOUNCE_ANGLES.rolling)
    columns = np.column_stack([change[:, None] * (wall[:, None] == np.arange(len(walls))), slip, before])
    prior = np.diag([0.0] * len(walls) + [1.0, 1.0])  # no friction takes more than the whole velocity
    values, inverse, z = np.zeros(len(prior)), prior, np.zeros(len(rows))
    for _ in range(ROUNDS if rows else 0):
        z = (moved - columns @ values) / std
        weight = t_weights(z / typical(z)) / (std * typical(z)) ** 2
        inverse = np.linalg.pinv((columns.T * weight) @ columns + prior)
        values = inverse @ (columns.T @ (weight * moved))
    angles, friction = np.split(values, [len(walls)])
    covariance = inverse[: len(walls), : len(walls)] * len(rows) / max(len(rows) - len(prior), 1)
    deflected = moved - columns[:, len(walls) :] @ friction
    spread = std * typical(z) if rows else std
    return BounceAngles(tuple(walls), angles, covariance, wall, deflected, spread, change, launch)


def _row(number: int, wall: str, jump: VelocityJump) -> tuple[float, ...]:
    """The number of the wall, the change of the velocity along it with standard deviation, that velocity before, the
    change of the velocity across, and the launch."""
    across, _ = wall_axis(wall)
    along = 1 - across
    change, both = jump.v_out - jump.v_in, [3 + along, 5 + along]
    variance = np.array([-1.0, 1.0]) @ jump.covariance[np.ix_(both, both)] @ np.array([-1.0, 1.0])
    return number, change[along], float(np.sqrt(variance)), jump.v_in[along], change[across], jump.launch
