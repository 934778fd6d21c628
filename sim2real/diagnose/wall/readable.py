"""The readable formula of an unlisted law of the bounces: how a restitution varies."""

from __future__ import annotations

import numpy as np

from sim2real.diagnose.contact_laws import acted_on
from sim2real.diagnose.engine.choose import Law
from sim2real.diagnose.engine.explain import Explained
from sim2real.diagnose.forms import Axis, Direction, Form, form, profiles
from sim2real.diagnose.formula import Formula, Rest, find_formula
from sim2real.diagnose.wall.data import KINDS
from sim2real.diagnose.wall.picture import NORMAL, View, coordinates, speeds
from sim2real.diagnose.wall.problem import WallProblem

NAMES = {"speed": ("v_n", "m/s"), "heading": ("angle", "deg"), "position": ("s", "m"), "time": ("t", "s"),
         "history": ("t_since_hit", "s")}  # fmt: skip
BOTH = "added to the restitution of both components"
CHANGES = ("added to the restitution", "added to the share of the tangential speed kept")
FEWEST = 12  # bounces of a wall that may have a law of its own


def readable(problem: WallProblem, found: Explained, law: Law, use: np.ndarray) -> tuple[Formula, View]:
    """The formula of an unlisted law of the bounces, fitted to the clusters `use`; and the view that shows it."""
    d, component = problem.data, acted_on(law)[0]
    label, values = coordinates(d)[law.family]
    walls = {"": np.ones(len(d), bool)}
    if law.family == "position":
        walls |= {name: here for name, kind in KINDS.items() if (here := d.kind == kind).sum() >= FEWEST}
    pushes = {CHANGES[component]: np.eye(2)[component] * speeds(d), BOTH: speeds(d)}
    forms: dict[str, tuple[Form, np.ndarray]] = {}
    for name, here in walls.items():
        axis = Axis(*NAMES[law.family], np.where(here, values, np.nan), component != NORMAL or bool(name))
        for words, push in pushes.items():
            side = Direction("change", "", f"{words} of the wall {name}" if name else words, push * here[:, None])
            made = [form(one, axis, [side], "1") for one in profiles(axis, "1")]
            forms |= {one.name: (one, here) for one in made}
    left = problem.residuals(found.final.values, found.final.free, np.arange(problem.clusters))
    now = problem.predicted(found.final.values)

    def respond(velocities: np.ndarray) -> np.ndarray:
        return problem.allowing(found.final.values, now, problem.whitened(velocities))

    rest = Rest(left.r, left.jacobian, left.cluster, use, respond)
    best = find_formula(rest, [one for one, _ in forms.values()], lambda one, shape: ())
    return best, View(label, np.where(forms[best.form.name][1], values, np.nan), component)
