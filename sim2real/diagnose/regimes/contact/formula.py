"""The readable formula of an unlisted contact law: how the share of the speed that the puck keeps varies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.formula.search import Formula, FormulaProblem, find_formula
from sim2real.diagnose.formula.shapes import Axis, Direction, form, profiles
from sim2real.diagnose.regimes.contact.candidates import components_of
from sim2real.diagnose.regimes.contact.problem import ContactProblem

NORMAL, TANGENT = 0, 1  # components of a velocity
BOTH = "added to the restitution of both components"
CHANGES = ("added to the restitution", "added to the share of the tangential speed kept")


@dataclass(frozen=True)
class ContactProjection:
    """The kept share of one velocity `component` over a `coordinate` (n,); contacts with nan are omitted.

    `label`: of the coordinate, with its unit; `ticks`: names of the values 0, 1, … if the coordinate is categorical.
    """

    label: str
    coordinate: np.ndarray
    component: int
    ticks: tuple[str, ...] = ()


def contact_formula(
    problem: ContactProblem,
    found: SearchResult,
    law: Law,
    use: np.ndarray,
    axis: Axis,
    places: Mapping[str, np.ndarray],
) -> tuple[Formula, np.ndarray]:
    """Fit a formula over `axis` to the clusters `use`; return it and the contacts (n,) bool that it applies to.

    places: by name, the contacts (n,) bool of each place that may have its own law; "" for all places.
    """
    component, forms = components_of(law)[0], {}
    speeds = np.zeros((len(problem.data), problem.each))
    speeds[:, :2] = problem.data.approach
    changes = {CHANGES[component]: np.eye(problem.each)[component] * speeds, BOTH: speeds}
    for name, here in places.items():
        level = component != NORMAL or bool(name)  # the baseline's restitution is the level of the normal component
        there = Axis(axis.name, axis.unit, np.where(here, axis.values, np.nan), level)
        for words, change in changes.items():
            direction = Direction("change", "", f"{words} of {name}" if name else words, change * here[:, None])
            made = [form(one, there, [direction], "1") for one in profiles(there, "1")]
            forms |= {one.name: (one, here) for one in made}
    best = find_formula(_formula_problem(problem, found, use), [one for one, _ in forms.values()])
    return best, forms[best.form.name][1]


def _formula_problem(problem: ContactProblem, found: SearchResult, use: np.ndarray) -> FormulaProblem:
    """The residuals under the final law, and their response to changes (n, each, k) of the velocities after."""
    values = found.final.values
    rest = problem.residuals(values, found.final.free, np.arange(problem.clusters))
    predicted = problem.predicted(values)

    def respond(changes: np.ndarray) -> np.ndarray:
        block = problem.whitened(problem.with_recoil(values, changes))
        return problem.with_common_noise(values, predicted, block)

    return FormulaProblem(rest.r, rest.jacobian, rest.cluster, use, float(problem.freedom[use].sum()), respond)
