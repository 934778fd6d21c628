"""The readable formula of an unlisted law of the walls, and the projection that shows it."""

from __future__ import annotations

import numpy as np

from puckpilot_env.physics.contacts import bounce
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.formula.search import Formula
from sim2real.diagnose.formula.shapes import Axis
from sim2real.diagnose.regimes.contact.candidates import components_of
from sim2real.diagnose.regimes.contact.formula import ContactProjection, contact_formula
from sim2real.diagnose.regimes.wall.data import KINDS
from sim2real.diagnose.regimes.wall.figures import coordinates
from sim2real.diagnose.regimes.wall.problem import WallProblem
from sim2real.diagnose.regimes.wall.tuned import WALL

# Symbol and unit of the coordinate in a formula, by the quantity that a law depends on
SYMBOLS = {"speed": ("v_n", "m/s"), "heading": ("angle", "deg"), "position": ("s", "m"), "time": ("t", "s"),
           "history": ("t_since_contact", "s")}  # fmt: skip


def readable_formula(
    problem: WallProblem, found: SearchResult, law: Law, use: np.ndarray
) -> tuple[Formula, ContactProjection]:
    """Fit the formula of an unlisted law to the clusters `use`; return it and the projection that shows it."""
    d = problem.data
    label, values = coordinates(d)[law.family]
    places = {"": np.ones(len(d), bool)}
    if law.family == "position":
        walls = {f"the wall {name}": d.kind == kind for name, kind in KINDS.items()}
        fitted = np.isin(d.cluster, use)
        places = {"": d.kind != bounce.POST}
        places |= {name: here for name, here in walls.items() if (here & fitted).sum() >= WALL.fewest_of_place}
    best, here = contact_formula(problem, found, law, use, Axis(*SYMBOLS[law.family], values), places)
    return best, ContactProjection(label, np.where(here, values, np.nan), components_of(law)[0])
