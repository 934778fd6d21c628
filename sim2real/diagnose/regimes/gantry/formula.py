"""The readable formula of an unlisted law of the gantry, extra volts on its axes, and the projection that shows it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.formula.search import Formula, FormulaProblem, find_formula
from sim2real.diagnose.formula.shapes import Axis, Direction, Form, form, harmonic, profiles
from sim2real.diagnose.regimes.gantry.basis_library import path_responses, signals
from sim2real.diagnose.regimes.gantry.problem import GantryProblem
from sim2real.diagnose.regimes.gantry.tuned import GANTRY_FIT, GANTRY_LAW

AXES = {"both axes": (0, 1), "x": (0,), "y": (1,)}
# By the last word of a law's name: the field of `Signals`, its symbol and unit in a formula, and its label
COORDINATES = {
    "place": (("place", "p", "m", "place along the axis [m]"),),
    "speed": (("speed", "speed", "m/s", "speed of the axis [m/s]"),),
    "volts": (
        ("voltage_size", "volts", "V", "volts of the axis [V]"),
        ("load", "volts_of_both", "V", "volts of both axes together [V]"),
    ),
    "time": (("t", "t", "s", "time [s]"),),
    "heading": (("heading", "heading", "deg", "heading [°]"),),
}
# By the first word: the field of `Signals` to which the volts are proportional, the unit and name of their ratio, and
# the words for the proportion
DRIVERS = {
    "force": ("ones", "V", "volts", "volts"),
    "loss": ("velocity", "V s/m", "volts for each m/s of speed", "times the speed"),
    "pull": ("voltage", "1", "volts for each volt", "times the volts"),
}


@dataclass(frozen=True)
class GantryProjection:
    """A projection of extra volts.

    `coordinate` (2 n,): of both axes, x before y; `driver` (2 n,): the signal to which the volts are proportional;
    `symbol`, `unit`, `label`: of the coordinate; `ratio_label`: of volts per driver.
    """

    symbol: str
    unit: str
    label: str
    ratio_label: str
    coordinate: np.ndarray
    driver: np.ndarray


def is_readable(law: Law) -> bool:
    """Whether a law of the gantry has a coordinate that a formula can be written over."""
    return law.name.split()[-1] in COORDINATES


def readable_formula(
    problem: GantryProblem, found: SearchResult, law: Law, use: np.ndarray
) -> tuple[Formula, GantryProjection]:
    """Fit the formula of an unlisted law to the clusters `use`; return it and the projection that shows it."""
    kind, coordinate = law.name.split()[0], law.name.split()[-1]
    _, unit, _, proportion = DRIVERS[kind]
    views = [_projection(problem, kind, *one) for one in COORDINATES[coordinate]]
    forms: dict[str, tuple[Form, GantryProjection]] = {}
    for view in views:
        axis = Axis(view.symbol, view.unit, view.coordinate, kind == "force")
        orders = range(1, GANTRY_LAW.harmonics + 1)
        shapes = [harmonic(k, unit) for k in orders] if coordinate == "heading" else None
        for name, axes in AXES.items():
            here = np.repeat([0 in axes, 1 in axes], len(view.coordinate) // 2)
            words = f"{'' if kind == 'force' else f'{proportion}, '}on {name}"
            direction = Direction("extra volts", "", words, (view.driver * here)[:, None])
            made = [form(one, axis, [direction], unit) for one in shapes or profiles(axis, unit)]
            forms |= {one.name: (one, view) for one in made}
    final = found.final.values
    begin = final if _is_possible(problem, final) else found.law.values  # about which the smooth term was linearized
    best = find_formula(_formula_problem(problem, found, use, begin), [one for one, _ in forms.values()])
    return _refitted(problem, found, use, best, begin), forms[best.form.name][1]


def _formula_problem(
    problem: GantryProblem, found: SearchResult, use: np.ndarray, values: Mapping[str, float]
) -> FormulaProblem:
    """The residuals at the parameters `values`, and their response to extra volts there."""
    p = problem.record(values)
    rest = problem.residuals(values, found.final.free, problem.everything)
    priors = len(rest.r) - sum(2 * len(run.windows.rows) for run in problem.runs)

    def respond(laws: np.ndarray) -> np.ndarray:
        columns = path_responses(problem, p, np.stack(np.split(laws[:, 0], 2), axis=1))
        return np.concatenate([columns, np.zeros((priors, columns.shape[1]))])

    return FormulaProblem(rest.r, rest.jacobian, rest.cluster, use, float(problem.freedom[use].sum()), respond)


def _is_possible(problem: GantryProblem, values: Mapping[str, float]) -> bool:
    """Whether no axis rings at the parameters `values`; a linear step may lead to such that do."""
    return bool(np.abs(problem.residuals(values, (), problem.everything).r).max() < GANTRY_FIT.impossible)


def _refitted(
    problem: GantryProblem, found: SearchResult, use: np.ndarray, first: Formula, begin: Mapping[str, float]
) -> Formula:
    """Refit the same form, linearised about the baseline's parameters that were fitted together with it, from `begin`
    on, as long as no step leads to an axis that rings."""
    free, final = found.final.free, found.final.values
    best, values, step = first, begin, first.moved
    for _ in range(GANTRY_LAW.formula_rounds):
        stepped = {**values, **{name: values[name] + float(by) for name, by in zip(free, step, strict=True)}}
        if not _is_possible(problem, stepped):
            step = np.zeros(len(free))
            break
        values = stepped
        best = find_formula(_formula_problem(problem, found, use, values), [best.form])
        step = best.moved
    total = np.array([values[name] - final[name] for name in free]) + step
    return replace(best, moved=total, gained=first.gained)


def _projection(problem: GantryProblem, kind: str, name: str, symbol: str, unit: str, label: str) -> GantryProjection:
    """The projection of laws of a `kind` over the field `name` of `Signals`."""
    driver_name, _, ratio_label, _ = DRIVERS[kind]
    both = [signals(problem.runs, axis) for axis in range(2)]
    coordinate, driver = (np.concatenate([getattr(one, field) for one in both]) for field in (name, driver_name))
    return GantryProjection(symbol, unit, label, ratio_label, coordinate, driver)
