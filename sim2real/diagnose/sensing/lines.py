"""The lines on which the puck's centre turns round at the walls, as the camera shows them: place and slant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.contacts import WALLS, Geometry, nominal_lines, turned_round, wall_axis
from sim2real.diagnose.robust import t_weights, typical
from sim2real.diagnose.strikes import Strike

FARTHEST = 0.06  # of the table's size, from the nominal line
SLANTS = np.linspace(-0.05, 0.05, 21)  # rad, of a wall against the axes of the camera, at which it is looked for
BAND = 0.006  # m, the width in which the touches of a wall lie
LEAST = 4  # touches: two more than a line has numbers
SHARE = 0.4  # of the candidates that must lie in the band


@dataclass(frozen=True)
class Line:
    """A wall's line: `values` (2,) its place [m] at the middle of the wall and its slant [1]; their `covariance`;
    `along`, `place`, `std` (n,) [m] of its touches, from the middle of the wall; `launch` (n,) of each."""

    values: np.ndarray
    covariance: np.ndarray
    along: np.ndarray
    place: np.ndarray
    std: np.ndarray
    launch: np.ndarray


def lines(found: list[Strike], g: Geometry, skip=()) -> dict[str, Line]:
    """The walls' lines from the strikes (not those of the launches `skip`); walls with too few touches are left out."""
    found = [s for s in found if s.launch not in skip and s.hit.where not in ("robot", "opponent")]
    each = {wall: _line(wall, found, g) for wall in WALLS}
    return {wall: line for wall, line in each.items() if line is not None}


def _line(wall: str, found: list[Strike], g: Geometry) -> Line | None:
    axis, _ = wall_axis(wall)
    size, middle = ((g.length, g.width / 2), (g.width, g.length / 2))[axis]
    near = [s for s in found if abs(s.place[axis] - nominal_lines(g)[wall]) < FARTHEST * size]
    near = [s for s in near if turned_round(wall, s.v_in, s.v_out)]
    if len(near) < LEAST:
        return None
    place = np.array([s.place[axis] for s in near])
    along = np.array([s.place[1 - axis] for s in near]) - middle
    std = np.sqrt([s.covariance[1 + axis, 1 + axis] for s in near])
    here = _densest(along, place)
    if here.sum() < max(LEAST, SHARE * len(near)):
        return None
    launch = np.array([s.launch for s in near])
    values, covariance = _straight(along[here], place[here], std[here])
    return Line(values, covariance, along[here], place[here], std[here], launch[here])


def _densest(along: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Which touches (n,) bool lie in the slanted band of width BAND that holds most of them."""
    best = np.zeros(len(place), bool)
    for slant in SLANTS[np.argsort(np.abs(SLANTS))]:
        level = place - slant * along
        inside = np.abs(level[:, None] - level) < BAND / 2
        fullest = inside[inside.sum(axis=1).argmax()]
        if fullest.sum() > best.sum():
            best = fullest
    return best


def _straight(along: np.ndarray, place: np.ndarray, std: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Place and slant (2,) of the line and their covariance (2, 2), with t-distributed errors."""
    basis = np.stack([np.ones_like(along), along], axis=1)
    values = np.array([np.median(place), 0.0])
    z, inverse = np.zeros_like(place), np.zeros((2, 2))
    for _ in range(20):
        z = (place - basis @ values) / std
        weight = t_weights(z) / std**2
        inverse = np.linalg.inv((basis.T * weight) @ basis)
        values = inverse @ (basis.T @ (weight * place))
    spread = typical(z)
    return values, inverse * spread**2 * len(place) / max(len(place) - 2, 1)
