"""Laws of the gantry as numbers that are fitted: what each is, its bounds, and the steps from law to law."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from puckpilot_env.parameters import make_records
from puckpilot_env.physics.gantry.mallet import axis_coefficients, axis_constants
from sim2real.identify.gantry.motion import CONSTANTS
from sim2real.identify.tuned import GANTRY


@dataclass(frozen=True)
class Number:
    """A number of a law.

    `none`: its value where its part of the law is off, NaN if it has no such value. `scale`: a change of it that
    matters. `low`, `high`: bounds of the search.
    """

    unit: str
    none: float
    scale: float
    low: float
    high: float
    meaning: str


NAN, ANY = math.nan, math.inf
NUMBERS: Mapping[str, Number] = {
    "c6_x": Number("V s^2", NAN, 1e-2, 1e-5, 1.0, "C6 of x: inertia"),
    "c6_y": Number("V s^2", NAN, 1e-2, 1e-5, 1.0, "C6 of y: inertia"),
    "c7_x": Number("V s", NAN, 5e-2, 1e-4, 10.0, "C7 of x: viscous friction and back EMF"),
    "c7_y": Number("V s", NAN, 5e-2, 1e-4, 10.0, "C7 of y: viscous friction and back EMF"),
    "friction_x": Number("V", 0.0, 0.5, -ANY, ANY, "Coulomb friction of the x axis"),
    "friction_y": Number("V", 0.0, 0.5, -ANY, ANY, "Coulomb friction of the y axis"),
    "friction_left": Number("V", 0.0, 0.5, -ANY, ANY, "Coulomb friction of the left motor"),
    "friction_right": Number("V", 0.0, 0.5, -ANY, ANY, "Coulomb friction of the right motor"),
    "balance": Number("1", 0.0, 0.03, -0.5, 0.5, "gain of the left motor above the mean of both"),
    "beyond": Number("1", 0.0, 0.3, 0.01, 0.95, "share of x's inertia beyond a belt that gives"),
    "belt_hz": Number("Hz", NAN, 30.0, 5.0, 120.0, "resonance of x with the shafts held"),
    "belt_damping": Number("1", NAN, 0.1, 0.0, 0.95, "its damping, part of critical"),
    "braking": Number("1", 0.0, 0.1, -1.0, 1.0, "share of its volts that a motor loses while it brakes"),
    "presliding": Number("m", NAN, 0.01, 1e-4, 0.3, "travel over which friction builds up"),
    "offset_x": Number("V", 0.0, 0.1, -ANY, ANY, "constant volts on x"),
    "offset_y": Number("V", 0.0, 0.1, -ANY, ANY, "constant volts on y"),
    "lag": Number("1", 1.0, 1.0, 0.1, 20.0, "C5 of both axes, in units of the default"),
    "deadband": Number("V", 0.0, 0.3, -ANY, ANY, "volts that each motor loses"),
    "sag": Number("1/V", 0.0, 0.01, -0.03, 0.2, "loss of volts with |V_left| + |V_right|"),
}


@dataclass(frozen=True)
class Step:
    """A step from a law to a richer one: its `words`, and the numbers that it frees with the `start` of each."""

    name: str
    words: str
    start: Mapping[str, float]


STEPS = (
    Step("friction_axes", "Coulomb friction of each axis", {"friction_x": 0.4, "friction_y": 0.4}),
    Step("friction_motors", "Coulomb friction of each motor", {"friction_left": 0.4, "friction_right": 0.4}),
    Step("balance", "motors of unequal strength", {"balance": 0.0}),
    Step("belt_x", "belt of x that gives", {"beyond": 0.5, "belt_hz": 30.0, "belt_damping": 0.05}),
    Step("braking", "motors weaker in braking than in driving", {"braking": 0.0}),
    Step("presliding", "friction that builds up over a travel", {"presliding": 0.01}),
    Step("offset", "constant volts on each axis", {"offset_x": 0.0, "offset_y": 0.0}),
    Step("lag", "C5 fitted", {"lag": 1.0}),
    Step("deadband", "deadband of each motor", {"deadband": 0.0}),
    Step("sag", "sag of the supply", {"sag": 0.0}),
)  # fmt: skip
THIRD_ORDER = ("c6_x", "c6_y", "c7_x", "c7_y")
AXES = (("x", -1.0), ("y", 1.0))  # and the sign of the other motor's coefficients


@dataclass(frozen=True)
class Law:
    """A law: the `values` of all numbers, of which `free` are fitted; `steps`: names of those beyond third order;
    `radius` [m]: of the pulleys."""

    values: Mapping[str, float]
    free: tuple[str, ...]
    steps: tuple[str, ...]
    radius: float

    def after(self, step: Step) -> Law:
        """The law with the numbers of a step free, at their starts."""
        values = {**self.values, **step.start}
        return Law(values, (*self.free, *step.start), (*self.steps, step.name), self.radius)

    def at(self, values: Mapping[str, float]) -> Law:
        """The law with other values of some numbers."""
        return Law({**self.values, **values}, self.free, self.steps, self.radius)

    @property
    def words(self) -> str:
        """The law in words."""
        return " + ".join(["third order", *(one.words for one in STEPS if one.name in self.steps)])

    def constants(self) -> np.void:
        """The constants (CONSTANTS) of the motion; NaN for an axis that is not overdamped."""
        c, values = np.zeros(1, CONSTANTS)[0], self.values
        for axis, (letter, _) in enumerate(AXES):
            c5 = values["lag"] * _defaults()[axis][0]
            slow, fast, *_ = axis_constants(c5, values[f"c6_{letter}"], values[f"c7_{letter}"], self.radius)
            c[f"slow_{letter}"], c[f"fast_{letter}"] = slow, fast
            c[f"gain_{letter}"] = 0.5 * self.radius / (c5 * fast)
        for name in set(c.dtype.names or ()).intersection(values):
            c[name] = values[name]
        c["belt_rate"] = 2.0 * math.pi * values["belt_hz"]
        return c

    def parameters(self) -> dict[str, float]:
        """The simulator's a1 ... b3: a is the mean of y's and x's coefficients, b half their difference."""
        found = {}
        for i, name in ((1, "c5"), (2, "c6"), (3, "c7")):
            x, y = (
                self.values["lag"] * _defaults()[axis][0] if name == "c5" else self.values[f"{name}_{letter}"]
                for axis, (letter, _) in enumerate(AXES)
            )
            found |= {f"a{i}": 0.5 * (x + y), f"b{i}": 0.5 * (y - x)}
        return found


def _defaults() -> list[tuple[float, float, float]]:
    """C5, C6, C7 of both axes with the simulator's defaults."""
    p = make_records(1)[0]
    return [axis_coefficients(p, axis) for axis in range(len(AXES))]


def as_shipped(radius: float) -> Law:
    """The third-order law with the simulator's defaults, for pulleys of this `radius` [m]."""
    values = {name: 0.0 if math.isnan(one.none) else one.none for name, one in NUMBERS.items()}
    for (letter, _), (_, c6, c7) in zip(AXES, _defaults(), strict=True):
        values |= {f"c6_{letter}": c6, f"c7_{letter}": c7}
    return Law({**values, "belt_hz": 30.0, "presliding": GANTRY.presliding}, THIRD_ORDER, (), radius)
