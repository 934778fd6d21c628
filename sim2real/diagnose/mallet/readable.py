"""The readable formula of an unlisted law of the blows, and its curve."""

from __future__ import annotations

import numpy as np

from sim2real.diagnose.binned import binned, half_band, over, singles
from sim2real.diagnose.contact_formula import CHANGES, contact_formula
from sim2real.diagnose.contact_laws import SLOWEST, UNIT, acted_on, shape_of
from sim2real.diagnose.engine.explain import Explained
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.finding import Curve
from sim2real.diagnose.forms import Axis
from sim2real.diagnose.formula import Formula
from sim2real.diagnose.mallet.families import COORDINATES, FAMILIES
from sim2real.diagnose.mallet.problem import MalletProblem

# by a family's coordinate: its symbol and unit in a formula, and its label
NAMES = {
    "speed": ("v_n", "m/s", "closing speed [m/s]"),
    "angle": ("angle", "deg", "angle from the normal [°]"),
    "place along the table": ("x", "m", "x [m]"),
    "place across the table": ("y", "m", "y [m]"),
    "time": ("t", "s", "time [s]"),
}


def readable(problem: MalletProblem, found: Explained, law: Law, use: np.ndarray) -> tuple[Formula, Curve]:
    """The formula of an unlisted law of the blows, fitted to the clusters `use`; and its curve."""
    symbol, unit, label = NAMES[shape_of(law)]
    u = COORDINATES[shape_of(law)][1](problem.data)
    u = np.degrees(u) if unit == "deg" else u
    formula, _ = contact_formula(problem, found, law, use, Axis(symbol, unit, u), {"": np.ones(len(u), bool)})
    return formula, _curve(problem, found, law, formula, u, label)


def _curve(problem: MalletProblem, found: Explained, law: Law, formula: Formula, u: np.ndarray, label: str) -> Curve:
    """The share that the law adds to what is kept; the blows are as far off it as they are off all that was fitted."""
    at, values = acted_on(law)[0], found.final.values
    going = (problem.data.closing, problem.data.sliding)[at]
    here = np.abs(going) > SLOWEST
    columns, going = UNIT * FAMILIES[shape_of(law)][1](problem.data)[here], going[here]
    added = columns @ found.coefficients
    std = problem.std[here, at] / np.abs(going)
    seen = (problem.observed - problem.predicted(values))[here, at] / going
    moved = dict(zip(found.final.free, formula.moved, strict=True))
    beside = problem.predicted({**values, **{name: values[name] + float(by) for name, by in moved.items()}})
    said = (beside - problem.predicted(values) + formula.form.field(formula.values))[here, at] / going
    points, shape = binned(u[here], seen, std), over(singles(u[here]), u[here], added, std)
    spread = found.theta_covariance[-len(law.columns) :, -len(law.columns) :]
    half = half_band(shape, std, columns, spread, found.law.clusters)
    return Curve(
        label, CHANGES[at], shape.x, shape.y, shape.y - half, shape.y + half, points.x, points.y, points.error,
        formula=over(shape.members, u[here], said, std).y,
    )  # fmt: skip
