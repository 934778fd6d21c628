"""The listed mechanisms of the concealed cases: the change of each, its size, and the scenarios that show it.

A mechanism draws its own size: `share` times the typical size, so that 0.5 is weak and 2 is strong. Its `values` go
into the key under the names that a diagnosis may use for its parameters; if the format allows several (the ratio e_t /
e_n, or e_n and e_t), under all of them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import cos, pi, sin
from typing import Any

import numpy as np

from sim2real.study.independent_table.physics.law import Law

Rng = np.random.Generator


@dataclass(frozen=True)
class Change:
    """The change of the law, the camera and the hand by a mechanism, and its parameters for the key."""

    law: dict[str, Any] = field(default_factory=dict)
    camera: dict[str, Any] = field(default_factory=dict)
    hand: dict[str, Any] = field(default_factory=dict)
    values: dict[str, float] = field(default_factory=dict)
    where: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Mechanism:
    """`draw(rng, share, law, scenario)` draws the change; `scenarios`: those that show it, most probable first."""

    regime: str
    scenarios: tuple[str, ...]
    draw: Callable[[Rng, float, Law, str], Change]


PUCK, TABLE_AND_PUCK = ("launches",), ("launches", "posts")
ROBOT, GANTRY = ("rally", "rally", "match"), ("gantry", "gantry", "drive")


def _sign(rng: Rng) -> float:
    return 1.0 if rng.uniform() < 0.5 else -1.0


def _tilt(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    heading, size = rng.uniform(-pi, pi), 0.023 * share
    values = {"tilt_x": size * cos(heading), "tilt_y": size * sin(heading)}
    return Change(law=values, values=values)


def _warp(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    one = rng.standard_normal(3)
    xx, yy, xy = 0.05 * share * one / np.linalg.norm(one)
    values = {"warp_xx": float(xx), "warp_yy": float(yy), "warp_xy": float(xy)}
    return Change(law=values, values=values)


def _linear_drag(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    return Change(law={"linear_drag": 0.08 * share}, values={"k": 0.08 * share})


def _patch(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    radius, extra = rng.uniform(0.15, 0.3), 0.15 * share
    x, y = rng.uniform(0.25, 0.75) * law.length, rng.uniform(0.3, 0.7) * law.width
    changes = {"patch_x": x, "patch_y": y, "patch_radius": radius, "patch_friction": extra}
    return Change(law=changes, values={"x": x, "y": y, "radius": radius, "extra": extra})


def _air_drift(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    rate = 0.008 * share  # positive, so that friction stays positive in a recording of any length
    return Change(law={"friction_drift": rate}, values={"rate": rate})


def _anisotropy(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    """Friction along x divided by that along y; either opposite to the motion, or a vector with two components."""
    size = 0.25 * share * _sign(rng)
    ratio = (1.0 + size) / (1.0 - size)
    if rng.uniform() < 0.5:
        return Change(law={"friction_anisotropy": size}, values={"ratio": ratio, "grain": size, "turning": 0.0})
    return Change(law={"friction_ratio": ratio}, values={"ratio": ratio, "grain": size, "turning": size})


def _side_force(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    size = 0.05 * share * _sign(rng)
    if rng.uniform() < 0.7:
        return Change(law={"side_force": size}, values={"coefficient": size})
    return Change(law={"spin_side_force": size / 8.0, "spin_decay": 0.2}, hand={"spin": 12.0})


def _speed_restitution(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    if rng.uniform() < 0.6:
        slope = 0.06 * share
        return Change(law={"restitution_slope": slope}, values={"e0": law.wall_restitution, "slope": slope})
    power = 0.12 * share
    return Change(law={"restitution_power": power}, values={"e0": law.wall_restitution, "exponent": power})


def _tangential(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    step = 0.1 * share
    e_t = law.wall_restitution + (step if law.wall_restitution + step < 0.98 else -step)
    values = {"e_n": law.wall_restitution, "e_t": e_t, "ratio": e_t / law.wall_restitution}
    return Change(law={"tangential_restitution": e_t}, values=values)


def _wall_spin(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    mu, decay = 0.15 * share, rng.uniform(0.1, 1.0)
    values = {"mu": mu, "kappa": law.spin_inertia, "decay": decay}
    return Change(law={"wall_spin": True, "wall_mu": mu, "spin_decay": decay}, values=values)


def _odd_wall(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    wall, delta = int(rng.integers(4)), 0.06 * share * _sign(rng)
    name = ("x0", "x1", "y0", "y1")[wall]
    changes = {"odd_wall": wall, "odd_wall_extra": delta}
    return Change(law=changes, values={"delta": delta}, where={"walls": [name]})


def _corner(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    e = max(0.05, law.wall_restitution - 0.2 * share)
    return Change(law={"post_restitution": e}, values={"e": e, "extra": e - law.wall_restitution})


def _mallet_speed(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    slope = 0.06 * share
    values = {"e0": law.mallet_restitution, "slope": slope}
    return Change(law={"mallet_restitution_slope": slope}, values=values)


def _plain(name: str, typical: float, *labels: str) -> Callable[..., Change]:
    """A mechanism with one parameter: the law's `name`, which a diagnosis may call by any of `labels`."""

    def draw(rng: Rng, share: float, law: Law, scenario: str) -> Change:
        value = typical * share
        return Change(law={name: value}, values=dict.fromkeys(labels, value))

    return draw


def _belt(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    hz, zeta = 14.0 / share, rng.uniform(0.05, 0.3)  # a softer belt is a stronger effect
    return Change(law={"belt_hz": hz, "belt_zeta": zeta}, values={"hz": hz, "zeta": zeta})


def _friction(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    """As on a real gantry: both motors and the y axis rub, the x axis hardly."""
    sizes = share * np.array([0.5, 0.5, 0.05, 0.7]) * rng.uniform(0.7, 1.3, 4)
    left, right, x, y = (float(one) for one in sizes)
    changes = {"motor_friction_left": left, "motor_friction_right": right, "axis_friction_x": x, "axis_friction_y": y}
    return Change(law=changes, values={"V_left": left, "V_right": right, "V_x": x, "V_y": y})


def _clock(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    drift = 4e-4 * share * _sign(rng)
    clock, stream = ("encoder_clock", "mallet") if scenario == "gantry" else ("camera_clock", "frames")
    return Change(law={clock: drift}, values={"ppm": 1e6 * drift}, where={"stream": stream})


def _scale(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    one = rng.standard_normal(3)
    x, y, shear = 0.015 * share * one / np.linalg.norm(one)
    changes = {"camera_scale_x": float(x), "camera_scale_y": float(y), "camera_shear": float(shear)}
    return Change(law=changes, values={"scale_x": float(x), "scale_y": float(y), "shear": float(shear)})


def _held(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    return Change(camera={"held": 0.15 * share}, values={"fraction": 0.15 * share})


def _stamps(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    late = 0.0006 * share
    return Change(camera={"jitter": 0.0, "arrival": late}, values={"std_s": late})


def _alignment(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    """The long walls are not parallel: the width changes by some millimetres along the table."""
    change = 0.004 * share * _sign(rng)  # m from one end to the other
    left = rng.uniform(0.0, 1.0)
    slopes = {"wall_slope_y0": -left * change / law.length, "wall_slope_y1": (1.0 - left) * change / law.length}
    angles = {"x0": 0.0, "x1": 0.0, "y0": slopes["wall_slope_y0"], "y1": slopes["wall_slope_y1"]}
    return Change(law=slopes, values={**angles, "angle": max(angles.values(), key=abs)})


MECHANISMS = {
    "table_tilt": Mechanism("glide", PUCK, _tilt),
    "table_warp": Mechanism("glide", PUCK, _warp),
    "linear_drag": Mechanism("glide", PUCK, _linear_drag),
    "friction_patch": Mechanism("glide", PUCK, _patch),
    "air_drift": Mechanism("glide", PUCK, _air_drift),
    "friction_anisotropy": Mechanism("glide", PUCK, _anisotropy),
    "side_force": Mechanism("glide", PUCK, _side_force),
    "speed_dependent_restitution": Mechanism("wall", PUCK, _speed_restitution),
    "tangential_restitution": Mechanism("wall", PUCK, _tangential),
    "wall_friction_spin": Mechanism("wall", PUCK, _wall_spin),
    "wall_to_wall_restitution": Mechanism("wall", PUCK, _odd_wall),
    "corner_restitution": Mechanism("corner", ("posts",), _corner),
    "mallet_speed_restitution": Mechanism("mallet", ROBOT, _mallet_speed),
    "mallet_friction": Mechanism("mallet", ROBOT, _plain("mallet_mu", 0.15, "mu")),
    "mallet_give": Mechanism("mallet", ROBOT, _plain("mallet_give", 0.2, "mass_ratio", "ratio")),
    "voltage_sag": Mechanism("gantry", GANTRY, _plain("voltage_sag", 0.02, "sag")),
    "motor_deadband": Mechanism("gantry", GANTRY, _plain("deadband", 0.4, "V")),
    "motor_friction": Mechanism("gantry", GANTRY, _friction),
    "command_delay": Mechanism("gantry", ("gantry",), _plain("command_delay", 0.015, "delay_s")),
    "belt_compliance": Mechanism("gantry", GANTRY, _belt),
    "backlash": Mechanism("gantry", GANTRY, _plain("backlash", 0.001, "gap")),
    "camera_delay": Mechanism("sensing", ROBOT, _plain("camera_delay", 0.018, "delay_s")),
    "clock_drift": Mechanism("sensing", ("gantry", "rally"), _clock),
    "scale_error": Mechanism("sensing", PUCK, _scale),
    "wall_alignment": Mechanism("wall", PUCK, _alignment),
    "held_frames": Mechanism("sensing", ("launches", "rally"), _held),
    "stamp_jitter": Mechanism("sensing", ("launches", "rally"), _stamps),
}
# Groups that must not occur in one law, because one mechanism cancels or hides the other
INCOMPATIBLE = (
    {"tangential_restitution", "wall_friction_spin"},
    {"belt_compliance", "backlash"},
)
