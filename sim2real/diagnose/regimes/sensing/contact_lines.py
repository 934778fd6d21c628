"""The walls' contact lines, where the puck's centre bounces, in the camera's coordinates: place and slant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.regimes.sensing.tuned import CONTACT_LINES
from sim2real.segmentation.causes import WALLS, Geometry, in_mouth, nominal_lines, turned_round, wall_axis
from sim2real.segmentation.velocity_jumps import VelocityJump
from sim2real.statistics.robust import t_weights, typical

# Slopes [1] of a wall against the camera's axes at which the line is searched
SLANTS = np.linspace(-CONTACT_LINES.most_slant, CONTACT_LINES.most_slant, CONTACT_LINES.slants)


@dataclass(frozen=True)
class ContactLine:
    """The contact line of a wall.

    `values` (2,): place [m] at the middle of the wall, and slant [1]; `covariance` (2, 2) of these. For each contact on
    the line: `along` (n,) [m]: place along the wall from its middle; `place` (n,) [m]: across, with standard deviation
    `std` (n,) [m]; `launch` (n,); and the velocity `jumps` (n) themselves.
    """

    values: np.ndarray
    covariance: np.ndarray
    along: np.ndarray
    place: np.ndarray
    std: np.ndarray
    launch: np.ndarray
    jumps: tuple[VelocityJump, ...]


def contact_lines(found: list[VelocityJump], g: Geometry, skip=()) -> dict[str, ContactLine]:
    """Estimate the contact lines, by name of the wall, from the velocity jumps `found` except those of launches `skip`.

    Walls with too few contacts are omitted.
    """
    found = [s for s in found if s.launch not in skip and s.contact.where not in ("robot", "opponent")]
    each = {wall: _line(wall, found, g) for wall in WALLS}
    return {wall: line for wall, line in each.items() if line is not None}


def _line(wall: str, found: list[VelocityJump], g: Geometry) -> ContactLine | None:
    """The line of one wall; None if too few contacts lie on it."""
    axis, _ = wall_axis(wall)
    size, middle = ((g.length, g.width / 2), (g.width, g.length / 2))[axis]
    near = [s for s in found if abs(s.place[axis] - nominal_lines(g)[wall]) < CONTACT_LINES.farthest * size]
    near = [s for s in near if turned_round(wall, s.v_in, s.v_out)]
    near = [s for s in near if not in_mouth(g, wall, s.place, CONTACT_LINES.band)]
    if len(near) < CONTACT_LINES.fewest_contacts:
        return None
    place = np.array([s.place[axis] for s in near])
    along = np.array([s.place[1 - axis] for s in near]) - middle
    std = np.sqrt([s.covariance[1 + axis, 1 + axis] for s in near])
    here = _densest(along, place)
    if here.sum() < max(CONTACT_LINES.fewest_contacts, CONTACT_LINES.least_share * len(near)):
        return None
    launch = np.array([s.launch for s in near])
    jumps = tuple(near[k] for k in np.flatnonzero(here))
    values, covariance = _fit_line(along[here], place[here], std[here])
    return ContactLine(values, covariance, along[here], place[here], std[here], launch[here], jumps)


def _densest(along: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Whether each contact (n,) bool lies in the slanted band of width `CONTACT_LINES.band` with the most contacts."""
    best = np.zeros(len(place), bool)
    for slant in SLANTS[np.argsort(np.abs(SLANTS))]:
        level = place - slant * along
        inside = np.abs(level[:, None] - level) < CONTACT_LINES.band / 2
        fullest = inside[inside.sum(axis=1).argmax()]
        if fullest.sum() > best.sum():
            best = fullest
    return best


def _fit_line(along: np.ndarray, place: np.ndarray, std: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Place and slant (2,) of the line and their covariance (2, 2), for errors with Student's t distribution."""
    basis = np.stack([np.ones_like(along), along], axis=1)
    values = np.array([np.median(place), 0.0])
    z, inverse = np.zeros_like(place), np.zeros((2, 2))
    for _ in range(20):
        z = (place - basis @ values) / std
        weight = t_weights(z) / std**2
        inverse = np.linalg.inv((basis.T * weight) @ basis)
        values = inverse @ (basis.T @ (weight * place))
    dispersion = typical(z)
    return values, inverse * dispersion**2 * len(place) / max(len(place) - 2, 1)
