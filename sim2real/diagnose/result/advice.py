"""What to record next if the data do not discriminate two laws or too few launches support a law."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine.experiment_design import information, most_informative
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.engine.problem import Problem
from sim2real.diagnose.result.result import Finding


def advice(problem: Problem, found: SearchResult, findings: Sequence[Finding], use: np.ndarray) -> str:
    """Return what to record next of a regime whose clusters `use` were fitted; "" if no question is open."""
    unclear = next((one for one in findings if one.also_possible), None)
    if unclear is not None:
        law = next(each for each in found.model.laws if each.name == unclear.mechanism)
        alternatives = [each for each in found.screen.listed if each.name in unclear.also_possible]
        others = [*found.model.minus(law).names, *(name for each in alternatives for name in each.columns)]
        purpose = f"to discriminate {unclear.mechanism} from {' or '.join(unclear.also_possible)}"
    elif found.inconclusive is not None:
        law, others = found.inconclusive, list(found.model.names)
        purpose = f"to test for {law.name}"
    else:
        return ""
    return f"{purpose}, record {_segments(problem, found, law, others, use) or EFFECTS[law.name].excited_by}"


def _segments(problem: Problem, found: SearchResult, law: Law, others: Sequence[str], use: np.ndarray) -> str:
    """Return the most informative kind of segments on a law beside the columns `others`; "" if there is none."""
    equations, units = found.screen.equations, problem.units.of(use)
    own = [name for name in law.columns if name not in others]
    theta = normal_equations.solve(equations, equations.columns([*others, *own]), units)[len(others) :]
    of_units = information(equations, units, own, theta, others)
    return most_informative(of_units, {name: of[units] for name, of in problem.units.kinds.items()}, problem.units.name)
