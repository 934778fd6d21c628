"""The rendered table: its curved surface, walls, lines, the markers round it, and all grey levels."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

ROUND = 256  # corners of the polygon for a circle
STANDARD_RING, LOW_RING = (
    0.090,
    0.040,
)  # m, heights of the opponent's ring on the two attachments; the report has neither


@dataclass(frozen=True)
class RenderedSurface:
    """The table's height z = a0 + a1 x + a2 y + a3 x^2 + a4 x y + a5 y^2 [m] (report eq. 15); flat by default."""

    coefficients: tuple[float, float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

    def height(self, x: np.ndarray | float, y: np.ndarray | float) -> np.ndarray | float:
        """Heights [m] at x, y [m]."""
        a0, a1, a2, a3, a4, a5 = self.coefficients
        return a0 + x * (a1 + a3 * x + a4 * y) + y * (a2 + a5 * y)

    def disc(self, x: float, y: float, radius: float, above: float = 0.0) -> np.ndarray:
        """The rim (ROUND, 3) [m] of a flat disc that is parallel to the surface, with its centre `above` it at x, y
        [m].

        The polygon has the circle's area; its edges differ from the circle by less than 3e-5 of the radius.
        """
        _, a1, a2, a3, a4, a5 = self.coefficients
        angle = 2.0 * np.pi / ROUND
        across, along = radius * np.sqrt(angle / np.sin(angle)) * _CIRCLE
        slope = a1 + 2.0 * a3 * x + a4 * y, a2 + a4 * x + 2.0 * a5 * y
        z = self.height(x, y) + above + slope[0] * across + slope[1] * along
        return np.stack([x + across, y + along, z], axis=1)

    def on(self, corners: np.ndarray, above: float = 0.0) -> np.ndarray:
        """Points (n, 3) [m] at places (n, 2), `above` the surface [m]."""
        return np.column_stack([corners, self.height(*corners.T) + np.full(len(corners), above)])


_CIRCLE = np.stack([trig(2.0 * np.pi * np.arange(ROUND) / ROUND) for trig in (np.cos, np.sin)])


@dataclass(frozen=True)
class Glint:
    """A bright reflection: an ellipse `above` the table's surface [m] with half-axes along x and y [m] and a grey
    level."""

    x: float
    y: float
    half_x: float
    half_y: float
    level: float
    above: float = 0.0


@dataclass(frozen=True)
class Marker:
    """An ArUco marker of the dictionary 4x4_50.

    corners: (4, 3) [m] of its black border, top left first, then clockwise as seen from above, in OpenCV's order.
    """

    number: int
    corners: np.ndarray

    @classmethod
    def lying(cls, number: int, x: float, y: float, z: float, size: float = 0.06) -> Marker:
        """A marker of a side length [m] that lies flat with its middle at x, y, z [m], upright as seen from the robot's
        end."""
        half = 0.5 * size
        steps = np.array([(half, half), (half, -half), (-half, -half), (-half, half)])
        return cls(number, np.column_stack([steps + np.array([x, y]), np.full(4, z)]))


@dataclass(frozen=True)
class Levels:
    """Grey levels, 0 to 255, in the picture's middle. Known is only that retro-reflective film is far brighter than
    everything else at 100 us (report 2.2.1); the numbers are chosen."""

    floor: float = 5.0
    table: float = 11.0
    line: float = 40.0
    wall: float = 16.0
    rail: float = 38.0
    paper: float = 110.0  # of markers
    ink: float = 7.0
    puck: float = 130.0
    ring: float = 130.0
    opponent: float = 12.0
    mallet: float = 26.0
    beam: float = 32.0
    carriage: float = 7.0
    streak: float = 170.0  # the beam's reflection of the lamp on the table


@dataclass(frozen=True)
class Table:
    """A table and the sizes of what is on it [m]; values without a source in the report are chosen.

    Not rendered: goal mouths, round corners, the side of the puck, shadows, and the opponent's hand and arm.
    """

    length: float = 2.0
    width: float = 1.0
    surface: RenderedSurface = RenderedSurface()
    wall_height: float = 0.03
    rail_width: float = 0.09
    puck_radius: float = 0.0309  # report C.2.3
    puck_height: float = 0.00585  # of its top, measured on the real table; 3.84 mm in report C.2.1
    mallet_radius: float = 0.0505
    mallet_height: float = 0.06
    ring_radius: float = 0.040
    ring_hole: float = 0.022
    ring_height: float = STANDARD_RING
    beam_width: float = 0.04
    beam_heights: tuple[float, float] = (0.07, 0.11)
    carriage: tuple[float, float, float] = (0.08, 0.09, 0.015)  # along x and y, and how high it is on top of the beam
    markers: tuple[Marker, ...] = ()
    glints: tuple[Glint, ...] = ()
    levels: Levels = field(default=Levels())

    @classmethod
    def with_markers(cls, length: float = 2.0, width: float = 1.0) -> Table:
        """A table of this length and width [m] with six markers beside the rails, as the real one has."""
        sides = width + 0.14, -0.14
        places = [(share * length, y) for share in (0.15, 0.55, 0.95) for y in sides]
        return cls(length, width, markers=tuple(Marker.lying(k, *place, 0.03) for k, place in enumerate(places)))
