"""One regime: what it lacks by those launches that are fitted, what stands of it on the others, and in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from sim2real.diagnose.account import account
from sim2real.diagnose.agreement import Part, check_agreement
from sim2real.diagnose.engine.explain import Explained, bare, explain
from sim2real.diagnose.engine.proving import Proved, prove
from sim2real.diagnose.finding import Account
from sim2real.diagnose.illustrate import illustrated
from sim2real.diagnose.problem import Problem
from sim2real.diagnose.wall.problem import WallProblem
from sim2real.diagnose.wall.scatter import explain_bounces

FEWEST_LAUNCHES, FEWEST_RESIDUALS = 4, 8  # of all recordings together: with fewer, nothing is said of a regime
TOO_ROUGH = "it rests on the glides, whose law is not known well enough"
TOO_LITTLE = "too little data"
MORE_OF = {
    "glide": "launches of the puck, twenty or more in all directions and from slow to fast",
    "wall": "bounces off all four walls, thirty or more, slow and fast, steep and flat",
    "mallet": "blows of the robot's mallet, thirty or more, some of them with the mallet at rest",
    "gantry": "plans of the gantry, a minute or more over its whole area",
}


def explain_regime(
    problem: Problem,
    law: Mapping[str, float],
    proof: np.ndarray,
    tables: Sequence[Part],
    clear: bool = True,
    proved: bool = True,
) -> tuple[Explained | None, Account, bool]:
    """What stands of a problem (None where there is too little data), its account, and whether a law by name, or none,
    explains what was fitted. What the regime rests on: `clear` to those who fit, and `proved` by untouched launches; if
    it is not, nothing is told that leaves much unexplained."""
    live = np.flatnonzero(problem.freedom > 0)
    use, apart = np.setdiff1d(live, proof), np.intersect1d(live, proof)
    if len(use) + len(apart) < FEWEST_LAUNCHES or not len(apart) or problem.freedom[use].sum() < FEWEST_RESIDUALS:
        return None, too_little(problem.regime), True
    shipped = {name: law[name] for name in problem.base}
    check_agreement(problem, shipped, tables)
    if isinstance(problem, WallProblem):
        problem, found = explain_bounces(problem, shipped, use, clear)
    else:
        found = explain(problem, shipped, use, clear)
    stands = prove(problem, found, apart, proved)
    told = account(problem, stands, shipped, use, apart)
    if not proved and (told.unexplained or told.lost):
        stands = Proved(bare(stands.found), {})
        told = replace(account(problem, stands, shipped, use, apart), undetermined=TOO_ROUGH, lost=False)
    elif (told.lost or told.unexplained) and not told.next_recording:
        told = replace(told, next_recording=f"record more {MORE_OF[problem.regime]}")
    if isinstance(problem, WallProblem) and problem.scatter.any():
        told = replace(told, doubt="; ".join(filter(None, (told.doubt, _scattering(problem)))))
    known = found.unlisted is None and not found.lost
    return stands.found, illustrated(problem, stands.found, told, use), known


def too_little(regime: str) -> Account:
    """The account of a regime of which hardly anything was seen."""
    return Account(regime, (), {}, False, None, TOO_LITTLE, f"record more {MORE_OF[regime]}")


def _scattering(problem: WallProblem) -> str:
    along, across = 100.0 * problem.scatter
    return (
        f"no two bounces are alike: beyond what the sensors err, they scatter by {along:.2g} % of the closing speed "
        f"along the normal and {across:.2g} % along the wall, which counts as noise here"
    )
