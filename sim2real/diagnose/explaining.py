"""One regime: what it lacks, what stands of it where each launch is predicted by the others, and in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from sim2real.diagnose.account import account
from sim2real.diagnose.agreement import Part, check_agreement
from sim2real.diagnose.effect_size import LEAST, effect_size
from sim2real.diagnose.engine.explain import Explained, bare, explain, without
from sim2real.diagnose.engine.selection import Selected, select
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


@dataclass(frozen=True)
class Identified:
    """What a regime lacks. `final`: what was found of it, None where there is too little data; `without`: the same less
    each law, by its name; `clear`: whether a law by name, or none, explains what was fitted."""

    problem: Problem | None
    account: Account
    final: Explained | None = None
    without: Mapping[str, Explained] = field(default_factory=dict)
    clear: bool = True

    @property
    def laws(self) -> tuple[str, ...]:
        """The law of each finding, by its name."""
        assert self.final is not None
        known = {law.mechanism if law.family else law.name: law.name for law in self.final.model.laws}
        return tuple(known[one.mechanism] for one in self.account.findings)


def identify_regime(
    problem: Problem, law: Mapping[str, float], tables: Sequence[Part], clear: bool = True, stands: bool = True
) -> Identified:
    """What a regime lacks. What it rests on: `clear` to those who fit, and whether it `stands` where launches are
    predicted by others; if it does not, nothing is named that leaves much unexplained."""
    live = np.flatnonzero(problem.freedom > 0)
    if len(live) < FEWEST_LAUNCHES or problem.freedom[live].sum() < FEWEST_RESIDUALS:
        return Identified(problem, too_little(problem.regime))
    shipped = {name: law[name] for name in problem.base}
    check_agreement(problem, shipped, tables)
    if isinstance(problem, WallProblem):
        problem, found = explain_bounces(problem, shipped, live, clear)
    else:
        found = explain(problem, shipped, live, clear)
    chosen = _that_matter(problem, select(problem, found, stands))
    told = account(problem, chosen, shipped)
    if not stands and (told.unexplained or told.lost):
        chosen = Selected(bare(chosen.found), {})
        told = replace(account(problem, chosen, shipped), undetermined=TOO_ROUGH, lost=False)
    elif (told.lost or told.unexplained) and not told.next_recording:
        told = replace(told, next_recording=f"record more {MORE_OF[problem.regime]}")
    if isinstance(problem, WallProblem) and problem.scatter.any():
        told = replace(told, doubt="; ".join(filter(None, (told.doubt, _scattering(problem)))))
    known = found.unlisted is None and not found.lost
    shown = illustrated(problem, chosen.found, told, chosen.found.clusters)
    said = Identified(problem, shown, chosen.found, chosen.without, known)
    sizes = [effect_size(problem, chosen.found, chosen.without[name]) for name in said.laws]
    findings = tuple(replace(one, size_m=size) for one, size in zip(shown.findings, sizes, strict=True))
    return replace(said, account=replace(shown, findings=findings))


def _that_matter(problem: Problem, chosen: Selected) -> Selected:
    """The laws without those of which nobody would notice anything, the smallest first."""
    while chosen.found.model.laws:
        sizes = {
            one.name: effect_size(problem, chosen.found, chosen.without[one.name]) for one in chosen.found.model.laws
        }
        name, size = min(sizes.items(), key=lambda one: one[1])
        if size >= LEAST[problem.regime]:
            break
        found = chosen.without[name]
        rest = {one.name: without(problem, found, one) for one in found.model.laws}
        chosen = replace(chosen, found=found, without=rest, small={**chosen.small, name: size})
    return chosen


def too_little(regime: str) -> Account:
    """The account of a regime of which hardly anything was seen."""
    return Account(regime, (), {}, False, None, TOO_LITTLE, f"record more {MORE_OF[regime]}")


def _scattering(problem: WallProblem) -> str:
    along, across = 100.0 * problem.scatter
    return (
        f"no two bounces are alike: beyond what the sensors err, they scatter by {along:.2g} % of the closing speed "
        f"along the normal and {across:.2g} % along the wall, which counts as noise here"
    )
