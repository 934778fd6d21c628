"""The readable formula of an unlisted law of the bounces, and the view that shows it."""

from __future__ import annotations

import numpy as np

from puckpilot_env.physics import bounce
from sim2real.diagnose.contact_formula import contact_formula
from sim2real.diagnose.contact_laws import acted_on
from sim2real.diagnose.engine.explain import Explained
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.forms import Axis
from sim2real.diagnose.formula import Formula
from sim2real.diagnose.wall.data import KINDS
from sim2real.diagnose.wall.picture import View, coordinates
from sim2real.diagnose.wall.problem import WallProblem

NAMES = {"speed": ("v_n", "m/s"), "heading": ("angle", "deg"), "position": ("s", "m"), "time": ("t", "s"),
         "history": ("t_since_hit", "s")}  # fmt: skip
FEWEST = 12  # bounces of a wall that may have a law of its own


def readable(problem: WallProblem, found: Explained, law: Law, use: np.ndarray) -> tuple[Formula, View]:
    """The formula of an unlisted law of the bounces, fitted to the clusters `use`; and the view that shows it."""
    d = problem.data
    label, values = coordinates(d)[law.family]
    places = {"": np.ones(len(d), bool)}
    if law.family == "position":
        walls = {f"the wall {name}": d.kind == kind for name, kind in KINDS.items()}
        told = np.isin(d.cluster, use)
        places = {"": d.kind != bounce.POST}
        places |= {name: here for name, here in walls.items() if (here & told).sum() >= FEWEST}
    best, here = contact_formula(problem, found, law, use, Axis(*NAMES[law.family], values), places)
    return best, View(label, np.where(here, values, np.nan), acted_on(law)[0])
