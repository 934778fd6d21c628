"""From what the engine found to what a diagnosis says: findings with formula, numbers, and proof."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine.alternatives import compare, nominal_p
from sim2real.diagnose.engine.cross_validation import Selection
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.least_squares import given, robust_loss
from sim2real.diagnose.engine.model_search import SearchResult, bare
from sim2real.diagnose.engine.null_controls import null_controls
from sim2real.diagnose.engine.problem import Problem
from sim2real.diagnose.engine.tuned import ENGINE
from sim2real.diagnose.regimes.base import Regime
from sim2real.diagnose.result.advice import advice
from sim2real.diagnose.result.labels import labelled
from sim2real.diagnose.result.result import MUCH, Estimate, Finding, Proof, RegimeResult
from sim2real.diagnose.result.whereabouts import whereabouts
from sim2real.statistics.intervals import reach_of_launches

ENOUGH = 4  # launches, to say that numbers of a law that does not explain them are better than others
MISFIT = "something is missing, but these data do not tell what"


def regime_result(regime: Regime, problem: Problem, chosen: Selection, defaults: Mapping[str, float]) -> RegimeResult:
    """What a regime says: laws as they were `chosen`, from the simulator's own numbers `defaults`."""
    found, crossed = chosen.found, chosen.cross_validation
    before, after = (crossed.rms(one) for one in (bare(found), found))
    findings = _findings(problem, chosen)
    refuted = bool(chosen.rejected and not findings)
    unseen = not findings and _unseen(problem, found, crossed.launches)
    misfit = found.misfit or refuted or unseen or (found.inconclusive is not None and not findings)
    return RegimeResult(
        problem.regime,
        findings,
        {name: found.final.estimate(name) for name in problem.base},
        found.defaults and not findings and not misfit,
        Proof(problem.noise_m * before, problem.noise_m * after, problem.noise_m, len(crossed.launches)),
        undetermined=MISFIT if misfit else "",
        next_recording=advice(problem, found, findings, found.clusters),
        doubt=_doubt(chosen),
        minor=_minor(regime, chosen),
        misfit=misfit,
        better=len(crossed.launches) >= ENOUGH
        and crossed.loss(bare(found)).sum() < crossed.loss(_unfitted(problem, found, defaults)).sum(),
    )


def _unfitted(problem: Problem, found: SearchResult, defaults: Mapping[str, float]) -> SearchResult:
    """The simulator's own numbers as they are."""
    return replace(bare(found), law=given({**found.baseline.values, **defaults}))


def _unseen(problem: Problem, found: SearchResult, launches: np.ndarray) -> bool:
    """Whether far more than noise is left of the launches; single bounces may be odd."""
    left = robust_loss(problem, problem.residuals(found.law.values, (), launches))[0]
    return left > MUCH**2 * max(float(problem.freedom[launches].sum()), 1.0)


def _findings(problem: Problem, chosen: Selection) -> tuple[Finding, ...]:
    """All findings; those first without which most is lost."""
    found, crossed = chosen.found, chosen.cross_validation
    if not found.model.laws:
        return ()
    misfit = {law.name: crossed.rms(chosen.without[law.name]) for law in found.model.laws}
    tried = np.isin(found.clusters, crossed.launches[ENGINE.launch_folds - 1 :: ENGINE.launch_folds])
    parts = (found.clusters[~tried], found.clusters[tried])
    controls = null_controls(found.screen.equations, problem.units, found.model, found.screen.listed, *parts)
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
        problem.regime, law.mechanism, also, (law.family,), law.name, _sizes(found, law), p_value,
        values=found.effect_parameters(), alternatives=alternatives,
    )  # fmt: skip


def _sizes(found: SearchResult, law: Law) -> Mapping[str, Estimate]:
    """The coefficients of a smooth law with their intervals."""
    near = reach_of_launches(found.law.clusters) * np.sqrt(np.diag(found.theta_covariance))
    return {
        f"c{i}": Estimate(float(value), float(value - half), float(value + half), "1")
        for i, (value, half) in enumerate(zip(found.coefficients, near[-len(law.columns) :], strict=True))
    }


def _minor(regime: Regime, chosen: Selection) -> str:
    laws = [f"{name} is significant, but makes only {1e3 * size:.2g} mm" for name, size in chosen.small.items()]
    return f"{'; '.join(laws)}; less than {1e3 * regime.least_size:g} mm is not reported" if laws else ""


def _doubt(chosen: Selection) -> str:
    found = chosen.found
    if chosen.rejected:
        names, others = (" and ".join(law.name for law in laws) for laws in (chosen.rejected, chosen.others))
        beside = f"; beside that, {others} leaves most unexplained" if others else ""
        return f"{names} would fit, but cross-validation over launches rejects it{beside}"
    if found.inconclusive is None:
        return ""
    return (
        f"{found.inconclusive.name} would fit, but what asks for it is in too few launches to tell it from an accident"
    )
