"""Projections of a force on a gliding puck: the coordinate of the figure, and the direction of the component."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.regimes.sliding.forces.motion import Motion

Column = Callable[[Motion], np.ndarray]


@dataclass(frozen=True)
class Projection:
    """A projection of forces.

    `coordinate`: function for values (n,) of a motion; `label`: its name with unit; `direction`: function for unit
    vectors (n, 2) of the component; `component`: its name.
    """

    label: str
    coordinate: Column
    component: str
    direction: Column

    def of(self, motion: Motion, vectors: np.ndarray) -> np.ndarray:
        """The component (n,) of vectors (n, 2)."""
        return np.einsum("na,na->n", self.direction(motion), vectors)


def heading(motion: Motion) -> np.ndarray:
    """Direction (n,) of the motion [°], 0 along x."""
    return np.degrees(np.arctan2(motion.velocity[:, 1], motion.velocity[:, 0]))


def speed(motion: Motion) -> np.ndarray:
    """Speed (n,) [m/s]."""
    return np.linalg.norm(motion.velocity, axis=1)


def distance(x: float, y: float) -> Column:
    """The distance (n,) [m] from the place (x, y) [m]."""
    return lambda motion: np.hypot(*(motion.place - (x, y)).T)


def fixed(x: float, y: float) -> Column:
    """The same unit vector (x, y) everywhere."""
    return lambda motion: np.tile([x, y], (len(motion.t), 1))


def around(x: float, y: float, turning: bool, braking: bool) -> Projection:
    """The projection of a force about the point (x, y) [m]: along the motion if `braking`, around the point if
    `turning`, otherwise away from it."""

    def outward(motion: Motion) -> np.ndarray:
        offset = motion.place - (x, y)
        unit = offset / np.maximum(np.linalg.norm(offset, axis=1, keepdims=True), 1e-9)
        return np.stack([-unit[:, 1], unit[:, 0]], axis=1) if turning else unit

    component, direction = ("round it, to the left", outward) if turning else ("away from it", outward)
    if braking:
        component, direction = DIRECTIONS["along"]
    return Projection(f"distance from ({x:.3g}, {y:.3g}) m [m]", distance(x, y), component, direction)


COORDINATES: dict[str, tuple[str, Column]] = {
    "x": ("x [m]", lambda motion: motion.place[:, 0]),
    "y": ("y [m]", lambda motion: motion.place[:, 1]),
    "speed": ("speed [m/s]", speed),
    "heading": ("heading [°]", heading),
    "time": ("time [s]", lambda motion: motion.t),
    "history": ("time since the last contact [s]", lambda motion: motion.since),
}
DIRECTIONS: dict[str, tuple[str, Column]] = {
    "along": ("along the motion", lambda motion: motion.along),
    "across": ("to the left of the motion", lambda motion: motion.across),
    "x": ("along x", fixed(1.0, 0.0)),
    "y": ("along y", fixed(0.0, 1.0)),
}
LISTED = {  # mechanism: coordinate and direction that show it best
    "linear_drag": ("speed", "along"),
    "air_drift": ("time", "along"),
    "friction_anisotropy": ("heading", "along"),
    "side_force": ("speed", "across"),
}


def view(coordinate: str, direction: str) -> Projection:
    """The projection with a coordinate and a direction, given by their names in COORDINATES and DIRECTIONS."""
    return Projection(*COORDINATES[coordinate], *DIRECTIONS[direction])


def listed_view(mechanism: str, values: Mapping[str, float]) -> Projection:
    """The projection that shows a listed mechanism of the glide best, for the parameters `values`."""
    if mechanism == "friction_patch":
        x, y = float(values["patch_x"]), float(values["patch_y"])
        return Projection("distance from the middle of the patch [m]", distance(x, y), *DIRECTIONS["along"])
    return view(*_names(mechanism, values))


def _names(mechanism: str, values: Mapping[str, float]) -> tuple[str, str]:
    """The names of the coordinate and the direction of a mechanism's projection."""
    if mechanism == "table_warp":
        axis = "x" if abs(values["warp_xx"]) > abs(values["warp_yy"]) else "y"
        return axis, axis
    if mechanism == "table_tilt":  # the same at all places and headings
        return "heading", "x" if abs(values["tilt_x"]) > abs(values["tilt_y"]) else "y"
    return LISTED[mechanism]


def varied(mechanism: str, values: Mapping[str, float], usual: Motion, x: np.ndarray) -> Motion:
    """A motion with `x` (n,) as the coordinate of the mechanism's projection; all other coordinates are fixed: the
    table's centre, heading along x, median speed and time of `usual`."""
    n = len(x)
    place, velocity = np.tile(0.5 * usual.size, (n, 1)), np.tile([float(np.median(speed(usual))), 0.0], (n, 1))
    t = np.full(n, float(np.median(usual.t)))
    if mechanism == "friction_patch":
        place = np.stack([values["patch_x"] + x, np.full(n, values["patch_y"])], axis=1)
    else:
        match _names(mechanism, values)[0]:
            case "x":
                place[:, 0] = x
            case "y":
                place[:, 1] = x
            case "speed":
                velocity[:, 0] = x
            case "heading":
                velocity = velocity[:, :1] * np.stack([np.cos(np.radians(x)), np.sin(np.radians(x))], axis=1)
            case "time":
                t = x
    unknown = np.full(n, np.nan)
    return Motion(t, place, velocity, unknown, unknown, unknown, usual.size, usual.speeds)
