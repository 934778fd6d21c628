"""From what the engine found to what a diagnosis says: findings with formula, numbers, and proof."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import Law, Model
from sim2real.diagnose.engine.explain import Explained
from sim2real.diagnose.engine.twins import twins
from sim2real.diagnose.finding import Account, Estimate, Finding, Proof
from sim2real.diagnose.labels import labelled
from sim2real.diagnose.problem import Problem
from sim2real.diagnose.where import whereabouts


def account(problem: Problem, found: Explained, use: np.ndarray, proof: np.ndarray) -> Account:
    """What a regime says: `found` by the engine on the clusters `use`, proved on the clusters `proof`."""
    before = _rms(problem, float(np.sum(problem.residuals(found.baseline.values, (), proof).r ** 2)), proof)
    after = _rms(problem, _left(problem, found, proof), proof)
    findings = [_listed(problem, found, law, before, after) for law in found.listed]
    if found.unlisted is not None:
        findings.append(_unlisted(problem, found, found.unlisted, before, after))
    if findings:
        controls = twins(found.screen.grams, problem.units, found.model, use, proof)
        findings = [replace(one, twins=controls) for one in findings]
    fitted = found.final
    return Account(
        problem.regime,
        tuple(sorted(findings, key=lambda one: one.p_value)),
        {name: fitted.estimate(name) for name in problem.base},
        found.shipped and not findings and not found.lost,
        Proof(before * problem.noise_m, after * problem.noise_m, problem.noise_m, len(proof)),
        undetermined="something is missing, but there is too little data to tell what" if found.lost else "",
        next_recording=_next(findings) or _once_more(found),
        doubt=_doubt(found),
        lost=found.lost,
    )


def _left(problem: Problem, found: Explained, proof: np.ndarray) -> float:
    """Sum of squares that the final law leaves of the clusters `proof`."""
    if found.unlisted is None:
        return float(np.sum(problem.residuals(found.law.values, (), proof).r ** 2))
    index, _ = Model(found.law.free, (found.unlisted,), (1.0,)).columns(found.columns.grams)
    return float(gram.losses(found.columns.grams, index, found.theta, problem.units.of(proof)).sum())


def _rms(problem: Problem, squares: float, proof: np.ndarray) -> float:
    return float(np.sqrt(squares / max(problem.freedom[proof].sum(), 1.0)))


def _listed(problem: Problem, found: Explained, law: Law, before: float, after: float) -> Finding:
    effect = EFFECTS[law.name]
    fitted = found.final
    rows = [name for name in problem.rows(law) if name in fitted.free]
    return Finding(
        effect.regime, law.name, tuple(found.also.get(law.name, ())), effect.depends_on, effect.law,
        labelled(law, fitted), found.chance[law.name], before, after, whereabouts(law, fitted.values),
        {**law.start, **{name: fitted.values[name] for name in rows}}, found.rivals.get(law.name, ()),
    )  # fmt: skip


def _unlisted(problem: Problem, found: Explained, law: Law, before: float, after: float) -> Finding:
    return Finding(
        problem.regime, law.mechanism, tuple(found.also.get(law.name, ())), (law.family,), law.name,
        _sizes(found, law), found.chance[law.name], before, after, {}, found.switched(), found.rivals.get(law.name, ()),
    )  # fmt: skip


def _sizes(found: Explained, law: Law) -> Mapping[str, Estimate]:
    """The coefficients of a smooth law with their intervals."""
    theta, spread = found.theta[-len(law.columns) :], np.sqrt(np.diag(found.theta_covariance))[-len(law.columns) :]
    return {
        f"c{k}": Estimate(float(value), float(value - 1.96 * std), float(value + 1.96 * std), "1")
        for k, (value, std) in enumerate(zip(theta, spread, strict=True))
    }


def _doubt(found: Explained) -> str:
    if found.doubtful is None:
        return ""
    return f"{found.doubtful.name} would fit, but what asks for it is in too few launches to tell it from an accident"


def _once_more(found: Explained) -> str:
    if found.doubtful is None:
        return ""
    return f"to make sure of {found.doubtful.name}, record {EFFECTS[found.doubtful.name].excited_by}"


def _next(findings: list[Finding]) -> str:
    unclear = [one for one in findings if one.also_possible]
    if not unclear:
        return ""
    one = unclear[0]
    names = " from ".join((one.mechanism, " or ".join(one.also_possible)))
    return f"to tell {names}, record {EFFECTS[one.mechanism].excited_by}"
