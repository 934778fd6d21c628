"""The readable formula of an unlisted law of bounces or of blows: how what a puck keeps of its speed varies."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sim2real.diagnose.contact_laws import acted_on
from sim2real.diagnose.contact_problem import ContactProblem
from sim2real.diagnose.engine.explain import Explained
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.forms import Axis, Direction, form, profiles
from sim2real.diagnose.formula import Formula, Rest, find_formula

NORMAL = 0
BOTH = "added to the restitution of both components"
CHANGES = ("added to the restitution", "added to the share of the tangential speed kept")


def contact_formula(
    problem: ContactProblem, found: Explained, law: Law, use: np.ndarray, axis: Axis, places: Mapping[str, np.ndarray]
) -> tuple[Formula, np.ndarray]:
    """The formula over a coordinate, fitted to the clusters `use`, and at which contacts (n,) it acts; `places`: which
    (n,) are at a place that may have a law of its own, by its name, "" for all."""
    component, forms = acted_on(law)[0], {}
    speeds = np.zeros((len(problem.data), problem.each))
    speeds[:, 0], speeds[:, 1] = problem.data.closing, problem.data.sliding
    pushes = {CHANGES[component]: np.eye(problem.each)[component] * speeds, BOTH: speeds}
    for name, here in places.items():
        level = component != NORMAL or bool(name)  # the baseline has one of its own for all that is normal
        there = Axis(axis.name, axis.unit, np.where(here, axis.values, np.nan), level)
        for words, push in pushes.items():
            side = Direction("change", "", f"{words} of {name}" if name else words, push * here[:, None])
            made = [form(one, there, [side], "1") for one in profiles(there, "1")]
            forms |= {one.name: (one, here) for one in made}
    best = find_formula(_rest(problem, found, use), [one for one, _ in forms.values()])
    return best, forms[best.form.name][1]


def _rest(problem: ContactProblem, found: Explained, use: np.ndarray) -> Rest:
    values = found.final.values
    left, now = problem.residuals(values, found.final.free, np.arange(problem.clusters)), problem.predicted(values)

    def respond(velocities: np.ndarray) -> np.ndarray:
        return problem.allowing(values, now, problem.whitened(problem.with_recoil(values, velocities)))

    return Rest(left.r, left.jacobian, left.cluster, use, respond)
