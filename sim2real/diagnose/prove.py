"""How far off what was identified is on data that nothing of it depends on: they change no word but these figures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from sim2real.diagnose.contacts import geometry
from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import Model
from sim2real.diagnose.engine.explain import Explained, bare
from sim2real.diagnose.explaining import Identified
from sim2real.diagnose.finding import Account, Proof
from sim2real.diagnose.gantry.problem import GantryProblem, gantry_problem
from sim2real.diagnose.gantry.run import UnusableError
from sim2real.diagnose.glide.data import join
from sim2real.diagnose.glide.problem import GlideProblem, States
from sim2real.diagnose.identify import Whole, blow_times, blows_of, states_of
from sim2real.diagnose.impacts import find_impacts
from sim2real.diagnose.mallet.problem import MalletProblem
from sim2real.diagnose.pieces import cut
from sim2real.diagnose.problem import Problem
from sim2real.diagnose.sensing.account import prove_sensing
from sim2real.diagnose.split import glides_of, launches_of
from sim2real.diagnose.wall.data import bounces
from sim2real.diagnose.wall.problem import WallProblem
from sim2real.recording import Recording


def prove(
    whole: Whole, recordings: Sequence[Recording], paths: Sequence[Recording], values: Mapping[str, float]
) -> tuple[Account, ...]:
    """The accounts of all regimes with their proof: of the puck by the frames of `recordings`, of the gantry by the
    mallet's path in `paths`; without one where these show nothing of a regime. `values` as in `identify`."""
    launch = launches_of(recordings, [cut(one) for one in recordings])
    sensing = prove_sensing(whole.sensed, recordings, launch)
    undone = [whole.sensed.undone(one) for one in recordings]
    problems = {**_puck(whole, undone, values), **_gantry(whole, undone, paths, values)}
    rest = [_proved(one, problems.get(name)) for name, one in whole.regimes.items()]
    return (sensing, *rest)


def _puck(whole: Whole, recordings: Sequence[Recording], values: Mapping[str, float]) -> dict[str, Problem]:
    """The puck's regimes in other recordings, under the law of the glides that was found."""
    known = whole.regimes.get("glide")
    if known is None or not isinstance(known.problem, GlideProblem):
        return {}
    pieces = [cut(one) for one in recordings]
    parts = [glides_of(*one) for one in zip(recordings, pieces, strict=True)]
    if not sum(part.glides for part in parts):
        return {}
    glides = GlideProblem(join(parts), values)
    law = {**values, **({} if known.final is None else known.final.final.values)}
    states = _states(glides, known.final, law)
    impacts = [find_impacts(some, glides, states, k) for k, some in enumerate(pieces)]
    found: dict[str, Problem] = {"glide": glides}
    walls = whole.regimes.get("wall")
    if walls is not None and isinstance(walls.problem, WallProblem):
        every = [hit for some in impacts for hit in some]
        hits = bounces(every, geometry(recordings[0]), walls.problem.data)
        scatter = (float(walls.problem.scatter[0]), float(walls.problem.scatter[1]))
        found["wall"] = WallProblem(hits, glides.clusters, law, scatter)
    struck = blows_of(recordings, impacts)
    if struck is not None:
        found["mallet"] = MalletProblem(struck, glides.clusters, law)
    return found


def _states(glides: GlideProblem, found: Explained | None, law: Mapping[str, float]) -> States:
    """`states_of` other glides, whose launches have numbers of their own where the law gives each launch one."""
    if found is None or found.unlisted is None or not found.unlisted.each_launch:
        return states_of(glides, found, law)
    columns = glides.columns(found.law.values, found.law.free, None)
    family = next(one for one in columns.families if one.name == found.unlisted.name)
    stepped = gram.moved(columns.grams, columns.grams.columns(found.law.free), found.theta[: len(found.law.free)])
    units = glides.units.of(np.arange(glides.clusters))
    own = gram.solve(stepped, columns.grams.columns(family.columns), units)
    return glides.states(found.final, family.name, own)


def _gantry(
    whole: Whole, recordings: Sequence[Recording], paths: Sequence[Recording], values: Mapping[str, float]
) -> dict[str, Problem]:
    known = whole.regimes.get("gantry")
    if known is None or not isinstance(known.problem, GantryProblem):
        return {}
    try:
        problem, _ = gantry_problem(paths, values, blow_times([cut(one) for one in recordings]))
    except UnusableError:
        return {}
    return {"gantry": known.problem.proved_on(problem.runs)}


def _proved(one: Identified, problem: Problem | None) -> Account:
    """The account with what the final laws, none of them, and all but each leave of other data."""
    live = np.zeros(0, int) if problem is None else np.flatnonzero(problem.freedom > 0)
    if problem is None or one.final is None or not len(live):
        return one.account
    before, after = (left_of(problem, each) for each in (bare(one.final), one.final))
    proof = Proof(problem.noise_m * before, problem.noise_m * after, problem.noise_m, len(live))
    findings = tuple(
        replace(each, before=left_of(problem, one.without[name]), after=after)
        for each, name in zip(one.account.findings, one.laws, strict=True)
    )
    return replace(one.account, findings=findings, proof=proof)


def left_of(problem: Problem, found: Explained) -> float:
    """Rms residual, in units of the noise, that laws leave of all that a problem shows."""
    live = np.flatnonzero(problem.freedom > 0)
    if found.unlisted is None or found.switched():
        squares = float(np.sum(problem.residuals(found.mended, (), live).r ** 2))
    else:
        squares = _left_by_family(problem, found, problem.units.of(live))
    return float(np.sqrt(squares / max(float(problem.freedom[live].sum()), 1.0)))


def _left_by_family(problem: Problem, found: Explained, units: np.ndarray) -> float:
    """Sum of squares that laws leave of units with a family that the simulator has no place for. Numbers that each
    launch has of its own are told by every second unit, and tried on those between."""
    assert found.unlisted is not None
    columns = problem.columns(found.law.values, found.law.free, None)
    family = next(one for one in columns.families if one.name == found.unlisted.name)
    grams, n = columns.grams, len(found.law.free)
    index, _ = Model(found.law.free, (family,), (1.0,)).columns(grams)
    if not family.each_launch:
        return float(gram.losses(grams, index, found.theta, units).sum())
    stepped = gram.moved(grams, grams.columns(found.law.free), found.theta[:n])
    total, odd = 0.0, np.arange(len(units)) % 2 == 1
    for tried in (odd, ~odd):
        own = gram.solve(stepped, grams.columns(family.columns), units[~tried])
        total += float(gram.losses(grams, index, np.concatenate([found.theta[:n], own]), units[tried]).sum())
    return total
