"""What to record next, where these data cannot tell two laws apart or rest on too few launches."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.explain import Explained
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.splitting import information, most_telling
from sim2real.diagnose.finding import Finding
from sim2real.diagnose.problem import Problem


def advice(problem: Problem, found: Explained, findings: Sequence[Finding], use: np.ndarray) -> str:
    """What to record next of a regime whose clusters `use` were explained; "" where nothing is open."""
    unclear = next((one for one in findings if one.also_possible), None)
    if unclear is not None:
        law = next(each for each in found.model.laws if each.name == unclear.mechanism)
        rivals = [each for each in found.screen.listed if each.name in unclear.also_possible]
        others = [*found.model.minus(law).names, *(name for each in rivals for name in each.columns)]
        purpose = f"to tell {unclear.mechanism} from {' or '.join(unclear.also_possible)}"
    elif found.doubtful is not None:
        law, others = found.doubtful, list(found.model.names)
        purpose = f"to see whether {law.name} is there"
    else:
        return ""
    return f"{purpose}, record {_pieces(problem, found, law, others, use) or EFFECTS[law.name].excited_by}"


def _pieces(problem: Problem, found: Explained, law: Law, others: Sequence[str], use: np.ndarray) -> str:
    """The pieces that tell most of a law beside the columns `others`, in words; "" where all tell alike."""
    grams, units = found.screen.grams, problem.units.of(use)
    own = [name for name in law.columns if name not in others]
    theta = gram.solve(grams, grams.columns([*others, *own]), units)[len(others) :]
    told = information(grams, units, own, theta, others)
    return most_telling(told, {name: of[units] for name, of in problem.units.kinds.items()}, problem.units.name)
