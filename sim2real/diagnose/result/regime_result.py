"""The result of a regime from the engine's selection: findings with formula, parameters, and residuals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine.alternatives import compare, nominal_p
from sim2real.diagnose.engine.cross_validation import Selection
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.least_squares import given, robust_loss
from sim2real.diagnose.engine.model_search import SearchResult, without_laws
from sim2real.diagnose.engine.null_controls import null_controls
from sim2real.diagnose.engine.problem import Problem
from sim2real.diagnose.engine.tuned import ENGINE
from sim2real.diagnose.regimes.base import Regime
from sim2real.diagnose.result.advice import advice
from sim2real.diagnose.result.labels import labelled
from sim2real.diagnose.result.result import Estimate, Finding, Proof, RegimeResult
from sim2real.diagnose.result.whereabouts import whereabouts
from sim2real.diagnose.tuned import IDENTIFICATION, RESIDUALS
from sim2real.statistics.intervals import reach_of_launches

MISFIT = "an effect is missing, but these data cannot identify it"


def regime_result(regime: Regime, problem: Problem, chosen: Selection, defaults: Mapping[str, float]) -> RegimeResult:
    """Return the result of a regime for the laws `chosen`, with the simulator's default parameters `defaults`."""
    found, validation = chosen.found, chosen.cross_validation
    before, after = (validation.rms(one) for one in (without_laws(found), found))
    findings = _findings(problem, chosen)
    refuted = bool(chosen.rejected and not findings)
    large_residuals = not findings and _has_large_residuals(problem, found, validation.launches)
    suspected = found.misfit or refuted or large_residuals or (found.inconclusive is not None and not findings)
    left = regime.misfit_size(problem, after)
    misfit = suspected and left >= regime.least_size
    return RegimeResult(
        problem.regime,
        findings,
        {name: found.final.estimate(name) for name in problem.base},
        found.defaults and not findings and not misfit,
        Proof(problem.noise_m * before, problem.noise_m * after, problem.noise_m, len(validation.launches)),
        undetermined=MISFIT if misfit else "",
        next_recording=advice(problem, found, findings, found.clusters),
        doubt=_doubt(chosen),
        minor=_minor(regime, chosen.small, left if suspected and not misfit else None),
        misfit=misfit,
        better=len(validation.launches) >= IDENTIFICATION.fewest_launches
        and validation.loss(without_laws(found)).sum()
        < validation.loss(_with_defaults(problem, found, defaults)).sum(),
    )


def _with_defaults(problem: Problem, found: SearchResult, defaults: Mapping[str, float]) -> SearchResult:
    """Return the result with the simulator's default parameters."""
    return replace(without_laws(found), law=given({**found.baseline.values, **defaults}))


def _has_large_residuals(problem: Problem, found: SearchResult, launches: np.ndarray) -> bool:
    """Return whether the robust residuals of the launches are far beyond noise."""
    loss = robust_loss(problem, problem.residuals(found.law.values, (), launches))[0]
    return loss > RESIDUALS.large**2 * max(float(problem.freedom[launches].sum()), 1.0)


def _findings(problem: Problem, chosen: Selection) -> tuple[Finding, ...]:
    """Return all findings, sorted by the residual without each, the largest first."""
    found, validation = chosen.found, chosen.cross_validation
    if not found.model.laws:
        return ()
    misfit = {law.name: validation.rms(chosen.without[law.name]) for law in found.model.laws}
    tested = np.isin(found.clusters, found.clusters[:: ENGINE.launch_folds])
    controls = null_controls(
        found.screen.equations, problem.units, found.model, found.screen.listed, found.clusters[~tested],
        found.clusters[tested], found.forward_selection.least,
    )  # fmt: skip
    ordered = sorted(found.model.laws, key=lambda law: -misfit[law.name])
    findings = [_unlisted(problem, found, law) if law.family else _listed(found, law) for law in ordered]
    return tuple(replace(one, null_controls=controls) for one in findings)


def _listed(found: SearchResult, law: Law) -> Finding:
    effect, fitted = EFFECTS[law.name], found.final
    own = {name: value for name, value in law.start.items() if name in law.rows}
    own |= {name: fitted.values[name] for name in law.rows if name in fitted.free}
    also, alternatives = compare(found.forward_selection, found.model, law, found.screen)
    p_value = nominal_p(found.forward_selection, found.model, law, found.screen)
    return Finding(
        effect.regime, law.name, also, effect.depends_on, effect.law, labelled(law, fitted), p_value,
        where=whereabouts(law, fitted.values), values=own,
        ranges={name: fitted.estimate(name) for name in law.rows if name in fitted.free}, alternatives=alternatives,
    )  # fmt: skip


def _unlisted(problem: Problem, found: SearchResult, law: Law) -> Finding:
    also, alternatives = compare(found.forward_selection, found.model, law, found.screen)
    p_value = nominal_p(found.forward_selection, found.model, law, found.screen)
    return Finding(
        problem.regime, law.mechanism, also, (law.family,), law.name, _coefficients(found, law), p_value,
        values=found.effect_parameters(), alternatives=alternatives,
    )  # fmt: skip


def _coefficients(found: SearchResult, law: Law) -> Mapping[str, Estimate]:
    """Return the coefficients of a smooth law with their 95 % intervals."""
    halves = reach_of_launches(found.law.clusters) * np.sqrt(np.diag(found.theta_covariance))
    return {
        f"c{i}": Estimate(float(value), float(value - half), float(value + half), "1")
        for i, (value, half) in enumerate(zip(found.coefficients, halves[-len(law.columns) :], strict=True))
    }


def _minor(regime: Regime, small: Mapping[str, float], left: float | None) -> str:
    """What is too small to report: the sizes [m] of `small` laws by name, and what is `left` unexplained."""
    words = [f"{name} is significant, but its effect is only {1e3 * size:.2g} mm" for name, size in small.items()]
    if left is not None:
        words.append(f"what no law explains is only {1e3 * left:.2g} mm")
    return f"{'; '.join(words)}; effects below {1e3 * regime.least_size:g} mm are not reported" if words else ""


def _doubt(chosen: Selection) -> str:
    found = chosen.found
    if chosen.rejected:
        names, others = (" and ".join(law.name for law in laws) for laws in (chosen.rejected, chosen.others))
        beside = f"; without it, {others} explains too little" if others else ""
        return f"{names} would fit, but cross-validation over launches rejects it{beside}"
    if found.inconclusive is None:
        return ""
    return f"{found.inconclusive.name} would fit, but too few launches support it"
