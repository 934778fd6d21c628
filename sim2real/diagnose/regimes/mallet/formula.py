"""The readable formula of an unlisted law of the mallet, and the projection that shows it."""

from __future__ import annotations

import numpy as np

from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.formula.search import Formula
from sim2real.diagnose.formula.shapes import Axis
from sim2real.diagnose.regimes.contact.candidates import basis_name_of, components_of
from sim2real.diagnose.regimes.contact.formula import ContactProjection, contact_formula
from sim2real.diagnose.regimes.mallet.basis_library import COORDINATES
from sim2real.diagnose.regimes.mallet.problem import MalletProblem

# By the name of a basis: the symbol and unit of its coordinate in a formula, and its label
SYMBOLS = {
    "speed": ("v_n", "m/s", "closing speed [m/s]"),
    "angle": ("angle", "deg", "angle from the normal [°]"),
    "place along the table": ("x", "m", "x [m]"),
    "place across the table": ("y", "m", "y [m]"),
    "time": ("t", "s", "time [s]"),
}


def readable_formula(
    problem: MalletProblem, found: SearchResult, law: Law, use: np.ndarray
) -> tuple[Formula, ContactProjection]:
    """Fit the formula of an unlisted law to the clusters `use`; return it and the projection that shows it."""
    symbol, unit, label = SYMBOLS[basis_name_of(law)]
    values = COORDINATES[basis_name_of(law)][1](problem.data)
    values = np.degrees(values) if unit == "deg" else values
    everywhere = {"": np.ones(len(values), bool)}
    formula, _ = contact_formula(problem, found, law, use, Axis(symbol, unit, values), everywhere)
    return formula, ContactProjection(label, values, components_of(law)[0])
