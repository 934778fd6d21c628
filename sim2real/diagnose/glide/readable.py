"""The readable formula of an unlisted force on a gliding puck, and from where to look at it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim2real.diagnose.engine.explain import Explained
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.forms import Axis, Direction, Form, Profile, form, harmonic, profiles
from sim2real.diagnose.formula import Formula, Rest, find_formula
from sim2real.diagnose.glide import swirls
from sim2real.diagnose.glide.families import HARMONICS, Motion, force
from sim2real.diagnose.glide.problem import GlideProblem
from sim2real.diagnose.glide.views import COORDINATES, DIRECTIONS, View, around, view

UNIT = "m/s^2"
NAMES = {"x": ("x", "m"), "y": ("y", "m"), "speed": ("v", "m/s"), "heading": ("heading", "deg"), "time": ("t", "s"),
         "history": ("t_since_hit", "s")}  # fmt: skip
SYMBOLS = {"along": "along", "across": "left", "x": "x", "y": "y"}


def readable(problem: GlideProblem, found: Explained, law: Law, use: np.ndarray) -> tuple[Formula, list[View]]:
    """The formula of a family of smooth forces that was found, fitted to the clusters `use`; and views that show it."""
    values = found.mended
    path, by_start = problem.linearised(values)
    motion = problem.motion(path)

    def respond(forces: np.ndarray) -> np.ndarray:
        return -problem.profiled(path, by_start, problem.bent(path, values, forces)[0])[1]

    left = problem.residuals(values, found.final.free, np.arange(problem.clusters))
    r = left.r
    if found.switched():  # it is in the path, and the formula is to stand in its place
        r = r + respond(force(law.name, motion, found.coefficients)[:, :, None])[:, 0]
    book = Book(motion, law)
    best = find_formula(Rest(r, left.jacobian, left.cluster, use, respond), book.single, book.joined)
    return best, book.views(best)


class Book:
    """The forms that a family's formula may have."""

    def __init__(self, motion: Motion, law: Law) -> None:
        kind = law.name.split()[0]
        self._motion = motion
        self._sides = {"push": ("x", "y"), "brake": ("along",), "side": ("across",)}.get(kind, ("along", "across"))
        self._of: dict[str, tuple[Profile, str, tuple[str, ...]]] = {}
        coordinates = ("x", "y") if law.family == "position" else (law.family,)
        self.single = [self._form(one, name, (side,)) for name in coordinates for side in self._sides
                       for one in self._profiles(name, side)]  # fmt: skip
        if law.family == "position":
            self.single += swirls.pushes(motion) if kind == "push" else [swirls.brake(motion)]

    def joined(self, one: Form, shape: np.ndarray) -> Sequence[Form]:
        """The same shape along both directions of the family, if it has two."""
        if one.name not in self._of or len(self._sides) == 1:
            return []
        profile, name, _ = self._of[one.name]
        return [self._form(replace(profile, grid=shape[None]), name, self._sides)]

    def views(self, best: Formula) -> list[View]:
        """From where a formula is seen best."""
        if best.form.name in self._of:
            _, name, sides = self._of[best.form.name]
            return [view(name, side) for side in sides]
        return [around(best.values["x"], best.values["y"], swirls.ROUND in best.form.name, best.form.name == "patch")]

    def _axis(self, name: str, side: str) -> Axis:
        symbol, unit = NAMES[name]
        offset = side != "along" and name != "history"  # along the motion the baseline's friction is one
        return Axis(symbol, unit, COORDINATES[name][1](self._motion), offset)

    def _profiles(self, name: str, side: str) -> list[Profile]:
        if name == "heading":
            return [harmonic(order, UNIT) for order in range(1, HARMONICS + 1)]
        return profiles(self._axis(name, side), UNIT)

    def _form(self, profile: Profile, name: str, sides: tuple[str, ...]) -> Form:
        directions = [
            Direction("a", SYMBOLS[side], DIRECTIONS[side][0], DIRECTIONS[side][1](self._motion)) for side in sides
        ]
        made = form(profile, self._axis(name, sides[0]), directions, UNIT)
        self._of[made.name] = (profile, name, sides)
        return made
