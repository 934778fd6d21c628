"""All that a blow may lack, as columns of its residuals: the listed effects, and smooth laws of any shape."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.contact_laws import contact_columns
from sim2real.diagnose.contact_problem import ContactProblem
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.mallet.data import Blows
from sim2real.diagnose.mallet.families import FAMILIES
from sim2real.diagnose.mallet.switched import OWNER, switched_on
from sim2real.diagnose.problem import Columns

FRICTIONS = (0.05, 0.1, 0.2, 0.4)  # at which friction is looked for


def mallet_columns(problem: ContactProblem[Blows], values: Mapping[str, float], free: Sequence[str]) -> Columns:
    """Every column of a mallet problem at one law."""
    listed = [name for name, effect in EFFECTS.items() if effect.regime == "mallet" and effect.listed]
    smooth = [Law(name, EFFECTS[name].row_names) for name in listed if name != "mallet_friction"]
    friction = ("mallet_friction", "mallet_mu", FRICTIONS)
    columns = contact_columns(problem, values, free, smooth, friction, FAMILIES, OWNER)
    switched = [
        replace(law, switch=partial(switched_on, law.name, problem.data), straight=True) for law in columns.families
    ]
    return replace(columns, families=switched)
