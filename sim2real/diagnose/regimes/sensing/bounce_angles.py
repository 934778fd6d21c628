"""The angles by which a sheared or turned map deflects bounces, from the velocities along the walls.

A wall changes the velocity along it by a law that is odd in that velocity, whatever its friction: it slows, or does
not. A map that is sheared or turned by an angle adds to each velocity along the wall its share of that across, so that
bounces are deflected, whichever way the puck goes. The long walls are met in any recording, the short ones may not be,
and the long walls alone tell a shear.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

from sim2real.diagnose.regimes.sensing.contact_lines import ContactLine
from sim2real.diagnose.regimes.sensing.tuned import BOUNCE_ANGLES, SCALE
from sim2real.segmentation.causes import wall_axis
from sim2real.statistics.robust import t_weights, typical

PAIRS = (("y0", "y1"), ("x0", "x1"))
ROUNDS = 20  # of reweighting


@dataclass(frozen=True)
class BounceAngles:
    """By how much bounces off `walls` are deflected: `values` (k,) [rad] with `covariance` (k, k)."""

    walls: tuple[str, ...]
    values: np.ndarray
    covariance: np.ndarray


@dataclass(frozen=True)
class _Bounces:
    """Bounces (n,) off walls: number of each one's `wall`; change of the velocity along it with standard deviation
    `std`; that velocity `before`; the velocity `across` before, and its `change` [m/s]; `launch`."""

    wall: np.ndarray
    along: np.ndarray
    std: np.ndarray
    before: np.ndarray
    across: np.ndarray
    change: np.ndarray
    launch: np.ndarray


def bounce_angles(lines: Mapping[str, ContactLine]) -> BounceAngles:
    """Estimate the angles of those pairs of opposite walls in `lines` that agree.

    Walls that deflect bounces differently are turned themselves, and one wall alone does not tell itself from a map.
    """
    walls = tuple(wall for pair in PAIRS if all(_often_met(lines, wall) for wall in pair) for wall in pair)
    if not walls:
        return BounceAngles((), np.zeros(0), np.zeros((0, 0)))
    values, covariance, _ = _fit(_bounces(lines, walls), np.zeros(len(walls)), free=True)
    kept = [k for k in range(len(walls)) if _alike(values, covariance, k - k % 2)]
    return BounceAngles(tuple(walls[k] for k in kept), values[kept], covariance[np.ix_(kept, kept)])


def deflections(lines: Mapping[str, ContactLine], shear: float) -> np.ndarray:
    """Errors (n, 4) of bounces off the long walls: the change of the velocity along that friction does not explain
    without and with a `shear`, its standard deviation [m/s], and the launch. None where the walls do not agree."""
    walls = tuple(wall for wall in bounce_angles(lines).walls if wall_axis(wall)[0] == 1)
    if not walls:
        return np.zeros((0, 4))
    bounces = _bounces(lines, walls)
    (*_, before), (*_, after) = (_fit(bounces, np.full(len(walls), angle), free=False) for angle in (0.0, shear))
    return np.stack([before, after, bounces.std * typical(after / bounces.std), bounces.launch], axis=1)


def _often_met(lines: Mapping[str, ContactLine], wall: str) -> bool:
    return wall in lines and len(lines[wall].jumps) >= BOUNCE_ANGLES.fewest_bounces


def _alike(values: np.ndarray, covariance: np.ndarray, first: int) -> bool:
    """Whether the walls `first` and the next deflect bounces by the same angle, and it is known."""
    pair, contrast = slice(first, first + 2), np.array([1.0, -1.0])
    variance = contrast @ covariance[pair, pair] @ contrast + 2 * BOUNCE_ANGLES.wall_std**2
    known = np.sqrt(np.diag(covariance)[pair].max()) < SCALE.known
    return bool(known and 2 * stats.norm.sf(abs(contrast @ values[pair]) / np.sqrt(variance)) > BOUNCE_ANGLES.alike)


def _bounces(lines: Mapping[str, ContactLine], walls: Sequence[str]) -> _Bounces:
    parts = []
    for number, wall in enumerate(walls):
        across, _ = wall_axis(wall)
        along, jumps = 1 - across, lines[wall].jumps
        both = np.ix_([3 + along, 5 + along], [3 + along, 5 + along])
        variance = [np.array([-1.0, 1.0]) @ jump.covariance[both] @ np.array([-1.0, 1.0]) for jump in jumps]
        v_in, v_out = (np.array([getattr(jump, name) for jump in jumps]) for name in ("v_in", "v_out"))
        change = v_out - v_in
        launch = np.array([jump.launch for jump in jumps])
        each = (change[:, along], np.sqrt(variance), v_in[:, along], v_in[:, across], change[:, across], launch)
        parts.append((np.full(len(jumps), number), *each))
    return _Bounces(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def _fit(bounces: _Bounces, angles: np.ndarray, free: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Fit a law of friction, and the `angles` (k,) of the walls if they are `free`, for errors with Student's t
    distribution: the angles, their covariance (k, k), and the residuals (n,) [m/s].

    Friction acts on the velocity along the wall itself, which the map shows with a share of that across.
    """
    count = len(angles) if free else 0
    prior = np.diag([0.0] * count + [1.0, 1.0])  # no friction takes more than the whole velocity
    friction, inverse, rest = np.zeros(2), prior, bounces.along
    for _ in range(ROUNDS):
        own = bounces.before - angles[bounces.wall] * bounces.across
        slipping = np.tanh(own / BOUNCE_ANGLES.rolling)
        laws = np.column_stack([np.abs(bounces.change) * slipping, own])
        rest = bounces.along - angles[bounces.wall] * bounces.change - laws @ friction
        deflected = bounces.change - friction[1] * bounces.across
        turned = deflected[:, None] * (bounces.wall[:, None] == np.arange(count))
        columns = np.column_stack([turned, laws])
        scale = bounces.std * typical(rest / bounces.std)
        weight = t_weights(rest / scale) / scale**2
        inverse = np.linalg.pinv((columns.T * weight) @ columns + prior)
        step = inverse @ (columns.T @ (weight * rest) - prior @ np.concatenate([np.zeros(count), friction]))
        angles = angles + step[:count] if free else angles
        friction = friction + step[count:]
    freedom = max(len(rest) - len(prior), 1)
    return angles, inverse[:count, :count] * len(rest) / freedom, rest
