"""The readable formula of an unlisted force on a gliding puck, and the projections that show it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.formula.search import Formula, FormulaProblem, find_formula
from sim2real.diagnose.formula.shapes import (
    Axis,
    Direction,
    Form,
    Profile,
    form,
    harmonic,
    profiles,
    pulses,
    sine,
    stripe,
)
from sim2real.diagnose.regimes.sliding.forces import central_forces
from sim2real.diagnose.regimes.sliding.forces.basis_library import HARMONICS, force
from sim2real.diagnose.regimes.sliding.forces.motion import Motion
from sim2real.diagnose.regimes.sliding.forces.searched_forces import Span, Wave, searched_force
from sim2real.diagnose.regimes.sliding.problem import GlideProblem
from sim2real.diagnose.regimes.sliding.views import COORDINATES, DIRECTIONS, Projection, around, view

UNIT = "m/s^2"
NAMES = {"x": ("x", "m"), "y": ("y", "m"), "speed": ("v", "m/s"), "heading": ("heading", "deg"), "time": ("t", "s"),
         "history": ("t_since_contact", "s")}  # fmt: skip
SYMBOLS = {"along": "along", "across": "left", "x": "x", "y": "y"}


def readable_formula(
    problem: GlideProblem, found: SearchResult, law: Law, use: np.ndarray
) -> tuple[Formula, list[Projection]]:
    """Fit the formula of a selected family of forces to the clusters `use`; return it and projections that show it."""
    values = found.all_values
    path, by_start = problem.linearized(values)
    motion = problem.motion(path)

    def respond(forces: np.ndarray) -> np.ndarray:
        """The response (2n, k) of the residuals to forces (n, 2, k) [m/s^2]."""
        return -problem.profiled(path, by_start, problem.displacements(path, values, forces)[0])[1]

    rest = problem.residuals(values, found.final.free, np.arange(problem.clusters))
    r = rest.r
    if found.effect_parameters():  # the path includes the effect, which the formula replaces
        r = r + respond(force(law.name, motion, found.coefficients)[:, :, None])[:, 0]
    candidates = FormulaCandidates(motion, law)
    remaining = FormulaProblem(r, rest.jacobian, rest.cluster, use, float(problem.freedom[use].sum()), respond)
    best = find_formula(remaining, candidates.single, candidates.joined)
    return best, candidates.views(best)


def near(force: Span | Wave, axis: Axis, unit: str) -> Profile:
    """The profile of a searched force, to be fitted near what was found."""
    if isinstance(force, Wave):
        return sine(axis, unit, np.array([force.period]))
    middle, width = 0.5 * (force.low + force.high), force.high - force.low
    if force.every:
        return pulses(axis, unit, np.array([[middle, width, force.every]]))
    return stripe(axis, unit, np.array([[middle, width]]))


class FormulaCandidates:
    """The candidate forms of a family's formula: `single` ones along one direction, and `joined` ones along two."""

    def __init__(self, motion: Motion, law: Law) -> None:
        kind = law.name.split()[0]
        self._motion = motion
        self._sides = {"push": ("x", "y"), "brake": ("along",), "side": ("across",)}.get(kind, ("along", "across"))
        self._of: dict[str, tuple[Profile, str, tuple[str, ...]]] = {}
        self._searched = searched_force(law.name)
        coordinates = ("x", "y") if law.family == "position" else (law.family,)
        if isinstance(self._searched, Span) and self._searched.of != "t":
            coordinates = (self._searched.of,)
        self.single = [self._form(one, name, (side,)) for name in coordinates for side in self._sides
                       for one in self._profiles(name, side)]  # fmt: skip
        if law.family == "position" and not self._searched:
            self.single += central_forces.pushes(motion) if kind == "push" else [central_forces.brake(motion)]

    def joined(self, one: Form, shape: np.ndarray) -> Sequence[Form]:
        """The form `one` with its parameters `shape` (k,) along both directions of the family, if it has two."""
        if one.name not in self._of or len(self._sides) == 1:
            return []
        profile, name, _ = self._of[one.name]
        return [self._form(replace(profile, grid=shape[None]), name, self._sides)]

    def views(self, best: Formula) -> list[Projection]:
        """The projections that show a formula best."""
        if best.form.name in self._of:
            _, name, sides = self._of[best.form.name]
            return [view(name, side) for side in sides]
        return [
            around(
                best.values["x"], best.values["y"], central_forces.ROUND in best.form.name, best.form.name == "patch"
            )
        ]

    def _axis(self, name: str, side: str) -> Axis:
        symbol, unit = NAMES[name]
        offset = side != "along" and name != "history"  # along the motion, the baseline's friction is the offset
        return Axis(symbol, unit, COORDINATES[name][1](self._motion), offset)

    def _profiles(self, name: str, side: str) -> list[Profile]:
        if name == "heading":
            return [harmonic(order, UNIT) for order in range(1, HARMONICS + 1)]
        axis = self._axis(name, side)
        return [*profiles(axis, UNIT), *([near(self._searched, axis, UNIT)] if self._searched else [])]

    def _form(self, profile: Profile, name: str, sides: tuple[str, ...]) -> Form:
        """The form of a profile over the coordinate `name`; it is stored so that `views` can find its projections."""
        directions = [
            Direction("a", SYMBOLS[side], DIRECTIONS[side][0], DIRECTIONS[side][1](self._motion)) for side in sides
        ]
        made = form(profile, self._axis(name, sides[0]), directions, UNIT)
        self._of[made.name] = (profile, name, sides)
        return made
