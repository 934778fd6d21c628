"""All that a bounce may lack, as columns of its residuals: the listed effects, and smooth laws of any shape."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.contact_laws import contact_columns, shape_of
from sim2real.diagnose.contact_problem import ContactProblem
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.problem import Columns
from sim2real.diagnose.wall.data import Bounces
from sim2real.diagnose.wall.families import FAMILIES, ONE_WAVE
from sim2real.diagnose.wall.switched import switched_on

FRICTIONS = (0.04, 0.07, 0.1, 0.15, 0.2, 0.3, 0.5)  # at which friction with spin is looked for
ONE_ROW_EACH = ("wall_to_wall_restitution", "speed_dependent_restitution")


def wall_columns(problem: ContactProblem[Bounces], values: Mapping[str, float], free: Sequence[str]) -> Columns:
    """Every column of a wall problem at one law."""
    friction = ("wall_friction_spin", "wall_mu", FRICTIONS)
    columns = contact_columns(problem, values, free, _smooth_in_the_effect(), friction, FAMILIES)
    return replace(columns, families=[_switched(law, problem) for law in columns.families])


def _switched(law: Law, problem: ContactProblem[Bounces]) -> Law:
    """The law with its switch, and with what it is one of where it is a single wave."""
    law = replace(law, switch=partial(switched_on, law.name, problem.data), straight=True)
    if shape_of(law) not in ONE_WAVE:
        return law
    return replace(law, searched=len(ONE_WAVE), among=f"{law.name.split(' by ', 1)[0]} by a wave")


def _smooth_in_the_effect() -> list[Law]:
    """Listed effects whose columns are derivatives at the baseline; each wall's own restitution is one, and so is each
    form of the fall with speed."""
    found = []
    for name, effect in EFFECTS.items():
        if effect.regime not in ("wall", "corner") or not effect.listed or name == "wall_friction_spin":
            continue
        if name in ONE_ROW_EACH:
            found += [Law(name, (row,)) for row in effect.row_names]
        else:
            found.append(Law(name, effect.row_names))
    return found
