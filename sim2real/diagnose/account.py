"""From what the engine found to what a diagnosis says: findings with formula, numbers, and proof."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from puckpilot_env.parameters import BY_NAME
from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.advice import advice
from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import Law
from sim2real.diagnose.engine.explain import Explained
from sim2real.diagnose.engine.fit import Fit, fit, soft_loss
from sim2real.diagnose.engine.rivals import chance, compare
from sim2real.diagnose.engine.twins import twins
from sim2real.diagnose.finding import MUCH, Account, Estimate, Finding, Proof, explained
from sim2real.diagnose.interval import reach_of_launches
from sim2real.diagnose.labels import labelled
from sim2real.diagnose.problem import Problem
from sim2real.diagnose.where import whereabouts

LOST = "something is missing, but these data do not tell what"
BORNE = 0.1  # of what untouched launches have beyond noise, that a law must explain to be told
FELT = 16.0  # the same difference of two laws' squares, below which it is chance that says which is better
LEAST_WORSE = 4.0  # growth of the sum of squares of untouched launches, in units of what it scatters by


def account(problem: Problem, found: Explained, use: np.ndarray, proof: np.ndarray) -> Account:
    """What a regime says: `found` by the engine on the clusters `use`, proved on the clusters `proof`.

    The proof chooses nothing, but it may silence: what foretells untouched launches no better than nothing is not told.
    """
    before, after = _squares(problem, found.baseline, proof), _left(problem, found, proof)
    refuted = _refuted(problem, found, proof, before, after)
    findings, unborne = ((), found.model.laws) if refuted else _findings(problem, found, use, proof, after)
    freedom = max(float(problem.freedom[proof].sum()), 1.0)
    if unborne and after > MUCH**2 * freedom:  # laws chosen beside wrong ones, and much is left: they stood in for it
        findings, unborne = (), found.model.laws
    refuted = refuted or bool(unborne and not findings)
    after = before if refuted else after
    rms = [problem.noise_m * float(np.sqrt(squares / freedom)) for squares in (before, after)]
    unseen = not findings and rms[1] > MUCH * problem.noise_m  # it happened in the untouched launches alone
    lost = found.lost or refuted or unseen or (found.doubtful is not None and not findings)
    return Account(
        problem.regime,
        findings,
        {name: found.final.estimate(name) for name in problem.base},
        found.shipped and not findings and not lost,
        Proof(rms[0], rms[1], problem.noise_m, len(proof)),
        undetermined=LOST if lost else "",
        next_recording=advice(problem, found, findings, use),
        doubt=_doubt(found, unborne),
        lost=lost,
    )


def _refuted(problem: Problem, found: Explained, proof: np.ndarray, plain: float, mended: float) -> bool:
    """Whether the clusters `proof` speak against the law: the squares that are left of them, `plain` without it and
    `mended` with it, do not fall, or those of their better part grow. Of numbers for each launch they say nothing, and
    nothing where they hardly feel the law."""
    if not found.model.laws or any(law.each_launch for law in found.model.laws):
        return False
    if found.unlisted is not None:
        return _likeness_refuted(problem, found, proof, mended >= plain)
    if _felt(problem, found.baseline, found.law, proof) < FELT * found.dispersion:
        return False
    laws = (found.baseline, found.law)
    before, after = (soft_loss(problem, problem.residuals(law.values, (), proof))[0] for law in laws)
    return mended >= plain or after > before + LEAST_WORSE * found.dispersion


def _likeness_refuted(problem: Problem, found: Explained, proof: np.ndarray, worse: bool) -> bool:
    """The same of a family, which is a likeness of the truth at best, and may fail where no launch that it was fitted
    to ever was: if those prove it to each other, untouched ones must be `worse` together by more than they scatter."""
    parts = problem.units.of(proof)
    before, after = (
        gram.soft(some, problem.units.freedom[parts] * found.dispersion)
        for some in (found.screen.grams.s[parts], found.losses(found.theta, parts))
    )
    launches = np.unique(problem.units.cluster[parts], return_inverse=True)[1]
    gained = np.bincount(launches, before - after)
    if len(gained) > 1 and found.chooser.proved(found.model):
        return float(gained.sum()) < -float(np.linalg.norm(gained))
    return worse or float(gained.sum()) < -LEAST_WORSE * found.dispersion


def _findings(
    problem: Problem, found: Explained, use: np.ndarray, proof: np.ndarray, after: float
) -> tuple[tuple[Finding, ...], tuple[Law, ...]]:
    """All findings, with the squares `after` that all of them leave of the clusters `proof`; those first that most gets
    lost without. And the laws without which no more would be left: untouched launches do not bear them out."""
    if not found.model.laws:
        return (), ()
    freedom = max(float(problem.freedom[proof].sum()), 1.0)
    others = [(law, _fit_without(problem, found, law, use)) for law in found.model.laws]
    without = [(law, _squares(problem, fitted, proof)) for law, fitted in others]
    sure = found.chooser.proved(found.model)  # then the proof need not feel it
    silent = [
        law for law, fitted in others
        if law.each_launch or (sure and law.family)
        or (found.unlisted is None and _felt(problem, fitted, found.law, proof) < FELT * found.dispersion)
    ]  # fmt: skip
    controls = twins(found.screen.grams, problem.units, found.model, found.screen.listed, use, proof)
    findings, unborne = [], []
    for law, before in sorted(without, key=lambda one: -one[1]):
        rms = [float(np.sqrt(squares / freedom)) for squares in (before, after)]
        if law not in silent and (before <= after or explained(*rms) < BORNE):
            unborne.append(law)
            continue
        told = _unlisted(problem, found, law, *rms) if law.family else _listed(found, law, *rms)
        findings.append(replace(told, twins=controls))
    return tuple(findings), tuple(unborne)


def _felt(problem: Problem, one: Fit, other: Fit, clusters: np.ndarray) -> float:
    """Squares of what two laws foretell differently of the clusters, in units of the noise."""
    left, right = (problem.residuals(law.values, (), clusters).r for law in (one, other))
    return float(np.sum((left - right) ** 2))


def _fit_without(problem: Problem, found: Explained, law: Law, use: np.ndarray) -> Fit:
    """The fit of the baseline and the listed laws but one; they alone where that one is a family."""
    others = [one for one in found.listed if one is not law]
    if not others:
        return found.baseline
    if len(others) == len(found.listed):
        return fit(problem, found.law.values, found.law.free, use)
    rows = law.rows
    free = [name for name in found.law.free if name not in rows]
    values = {**found.law.values, **{name: BY_NAME[name].default for name in rows}}
    return fit(problem, values, free, use)


def _squares(problem: Problem, law: Fit, proof: np.ndarray) -> float:
    """Sum of squares that a law of parameters leaves of the clusters `proof`."""
    return float(np.sum(problem.residuals(law.values, (), proof).r ** 2))


def _left(problem: Problem, found: Explained, proof: np.ndarray) -> float:
    """Sum of squares that the final law leaves of the clusters `proof`."""
    if found.unlisted is None:
        return _squares(problem, found.law, proof)
    return float(found.losses(found.theta, problem.units.of(proof)).sum())


def _listed(found: Explained, law: Law, before: float, after: float) -> Finding:
    effect = EFFECTS[law.name]
    fitted = found.final
    rows = [name for name in law.rows if name in fitted.free]
    also, rivals = compare(found.chooser, found.model, law, found.screen)
    return Finding(
        effect.regime, law.name, also, effect.depends_on, effect.law, labelled(law, fitted),
        chance(found.chooser, found.model, law, found.screen), before, after, whereabouts(law, fitted.values),
        {**law.start, **{name: fitted.values[name] for name in rows}}, rivals,
    )  # fmt: skip


def _unlisted(problem: Problem, found: Explained, law: Law, before: float, after: float) -> Finding:
    also, rivals = compare(found.chooser, found.model, law, found.screen)
    return Finding(
        problem.regime, law.mechanism, also, (law.family,), law.name, _sizes(found, law),
        chance(found.chooser, found.model, law, found.screen), before, after, {}, found.switched(), rivals,
    )  # fmt: skip


def _sizes(found: Explained, law: Law) -> Mapping[str, Estimate]:
    """The coefficients of a smooth law with their intervals."""
    near = reach_of_launches(found.law.clusters) * np.sqrt(np.diag(found.theta_covariance))
    k = len(law.columns)
    return {
        f"c{i}": Estimate(float(value), float(value - half), float(value + half), "1")
        for i, (value, half) in enumerate(zip(found.theta[-k:], near[-k:], strict=True))
    }


def _doubt(found: Explained, unborne: Sequence[Law]) -> str:
    if unborne:
        names = " and ".join(law.name for law in unborne)
        return f"{names} would fit, but does not foretell untouched launches any better"
    if found.doubtful is None:
        return ""
    return f"{found.doubtful.name} would fit, but what asks for it is in too few launches to tell it from an accident"
