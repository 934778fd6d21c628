"""Candidate laws of mallet contacts as columns of the design matrix: listed effects and smooth laws."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.problem import DesignMatrix
from sim2real.diagnose.regimes.contact.candidates import contact_design_matrix
from sim2real.diagnose.regimes.contact.problem import ContactProblem
from sim2real.diagnose.regimes.mallet.as_effect import PREFIX, effect_parameters
from sim2real.diagnose.regimes.mallet.basis_library import BASIS_LIBRARY
from sim2real.diagnose.regimes.mallet.data import MalletContacts
from sim2real.diagnose.regimes.mallet.tuned import MALLET

FRICTION = "mallet_friction"


def mallet_design_matrix(
    problem: ContactProblem[MalletContacts], values: Mapping[str, float], free: Sequence[str], only: Sequence[Law] = ()
) -> DesignMatrix:
    """All columns of a mallet problem at the parameters `values`; parameter columns: those of the base and `free`;
    `only`: see `Problem.columns`."""
    friction = (FRICTION, "mallet_mu", MALLET.frictions)
    columns = contact_design_matrix(
        problem, values, free, _derivative_laws(), friction, BASIS_LIBRARY, only=only, prefix=PREFIX
    )
    return replace(columns, families=[_with_effect(law, problem) for law in columns.families])


def _with_effect(law: Law, problem: ContactProblem[MalletContacts]) -> Law:
    """Add the simulator's effect to the law."""
    return replace(law, switch=partial(effect_parameters, law.name, problem.data), linear=True)


def _derivative_laws() -> list[Law]:
    """Listed effects whose columns are derivatives at the baseline."""
    return [
        Law(name, effect.row_names)
        for name, effect in EFFECTS.items()
        if effect.regime == "mallet" and effect.listed and name != FRICTION
    ]
