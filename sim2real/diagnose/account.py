"""From what the engine found to what a diagnosis says: findings with formula, numbers, and proof."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.advice import advice
from sim2real.diagnose.engine.choose import Law
from sim2real.diagnose.engine.explain import Explained, bare
from sim2real.diagnose.engine.fit import soft_loss
from sim2real.diagnose.engine.proving import Proved
from sim2real.diagnose.engine.rivals import chance, compare
from sim2real.diagnose.engine.twins import twins
from sim2real.diagnose.finding import MUCH, Account, Estimate, Finding, Proof
from sim2real.diagnose.interval import reach_of_launches
from sim2real.diagnose.labels import labelled
from sim2real.diagnose.problem import Problem
from sim2real.diagnose.where import whereabouts

ENOUGH = 4  # untouched launches, to say that numbers of a law that does not explain them are better than others
LOST = "something is missing, but these data do not tell what"


def account(
    problem: Problem, proved: Proved, shipped: Mapping[str, float], use: np.ndarray, proof: np.ndarray
) -> Account:
    """What a regime says: what the engine found on the clusters `use`, from the simulator's own numbers `shipped`, and
    what stands of it, `proved` on `proof`."""
    found = proved.found
    before, after = (_rms(problem, one, proof) for one in (bare(found), found))
    findings = _findings(problem, proved, use, proof, after)
    refuted = bool(proved.silenced and not findings)
    unseen = not findings and _unseen(problem, found, proof)  # it happened in the untouched launches alone
    lost = found.lost or refuted or unseen or (found.doubtful is not None and not findings)
    return Account(
        problem.regime,
        findings,
        {name: found.final.estimate(name) for name in problem.base},
        found.shipped and not findings and not lost,
        Proof(problem.noise_m * before, problem.noise_m * after, problem.noise_m, len(proof)),
        undetermined=LOST if lost else "",
        next_recording=advice(problem, found, findings, use),
        doubt=_doubt(proved),
        lost=lost,
        better=len(proof) >= ENOUGH and _soft(problem, found.baseline.values, proof) < _soft(problem, shipped, proof),
    )


def _unseen(problem: Problem, found: Explained, proof: np.ndarray) -> bool:
    """Whether far more than noise is left of untouched launches; single bounces may be odd."""
    left = _soft(problem, found.law.values, proof)
    return left > MUCH**2 * max(float(problem.freedom[proof].sum()), 1.0)


def _soft(problem: Problem, values: Mapping[str, float], proof: np.ndarray) -> float:
    return soft_loss(problem, problem.residuals(values, (), proof))[0]


def _findings(
    problem: Problem, proved: Proved, use: np.ndarray, proof: np.ndarray, after: float
) -> tuple[Finding, ...]:
    """All findings, with the rms residual `after` that all of them leave of the clusters `proof`; those first that most
    gets lost without."""
    found = proved.found
    if not found.model.laws:
        return ()
    without = [(law, _rms(problem, proved.without[law.name], proof)) for law in found.model.laws]
    controls = twins(found.screen.grams, problem.units, found.model, found.screen.listed, use, proof)
    findings = []
    for law, before in sorted(without, key=lambda one: -one[1]):
        told = _unlisted(problem, found, law, before, after) if law.family else _listed(found, law, before, after)
        findings.append(replace(told, twins=controls))
    return tuple(findings)


def _rms(problem: Problem, found: Explained, proof: np.ndarray) -> float:
    """Rms residual that what was found leaves of the clusters `proof`, in units of the noise."""
    if found.unlisted is None:
        squares = float(np.sum(problem.residuals(found.law.values, (), proof).r ** 2))
    else:
        squares = float(found.left(problem.units.of(proof)).sum())
    return float(np.sqrt(squares / max(float(problem.freedom[proof].sum()), 1.0)))


def _listed(found: Explained, law: Law, before: float, after: float) -> Finding:
    effect = EFFECTS[law.name]
    fitted = found.final
    own = {name: value for name, value in law.start.items() if name in law.rows}
    own |= {name: fitted.values[name] for name in law.rows if name in fitted.free}
    also, rivals = compare(found.chooser, found.model, law, found.screen)
    return Finding(
        effect.regime, law.name, also, effect.depends_on, effect.law, labelled(law, fitted),
        chance(found.chooser, found.model, law, found.screen), before, after, whereabouts(law, fitted.values),
        own, {name: fitted.estimate(name) for name in law.rows if name in fitted.free}, rivals,
    )  # fmt: skip


def _unlisted(problem: Problem, found: Explained, law: Law, before: float, after: float) -> Finding:
    also, rivals = compare(found.chooser, found.model, law, found.screen)
    return Finding(
        problem.regime, law.mechanism, also, (law.family,), law.name, _sizes(found, law),
        chance(found.chooser, found.model, law, found.screen), before, after, {}, found.switched(), {}, rivals,
    )  # fmt: skip


def _sizes(found: Explained, law: Law) -> Mapping[str, Estimate]:
    """The coefficients of a smooth law with their intervals."""
    near = reach_of_launches(found.law.clusters) * np.sqrt(np.diag(found.theta_covariance))
    return {
        f"c{i}": Estimate(float(value), float(value - half), float(value + half), "1")
        for i, (value, half) in enumerate(zip(found.coefficients, near[-len(law.columns) :], strict=True))
    }


def _doubt(proved: Proved) -> str:
    found = proved.found
    if proved.silenced:
        names, others = (" and ".join(law.name for law in laws) for laws in (proved.silenced, proved.others))
        beside = f"; beside that, {others} leaves most unexplained" if others else ""
        return f"{names} would fit, but untouched launches do not bear it out{beside}"
    if found.doubtful is None:
        return ""
    return f"{found.doubtful.name} would fit, but what asks for it is in too few launches to tell it from an accident"
