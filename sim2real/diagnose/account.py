"""From what the engine found to what a diagnosis says: findings with formula, numbers, and proof."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.advice import advice
from sim2real.diagnose.effect_size import LEAST
from sim2real.diagnose.engine.explain import Explained, bare
from sim2real.diagnose.engine.fit import given, soft_loss
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.rivals import chance, compare
from sim2real.diagnose.engine.selection import FOLDS, CrossValidated, Selected
from sim2real.diagnose.engine.twins import twins
from sim2real.diagnose.finding import MUCH, Account, Estimate, Finding, Proof
from sim2real.diagnose.interval import reach_of_launches
from sim2real.diagnose.labels import labelled
from sim2real.diagnose.problem import Problem
from sim2real.diagnose.where import whereabouts

ENOUGH = 4  # launches, to say that numbers of a law that does not explain them are better than others
LOST = "something is missing, but these data do not tell what"


def account(problem: Problem, chosen: Selected, shipped: Mapping[str, float]) -> Account:
    """What a regime says: laws as they were `chosen`, from the simulator's own numbers `shipped`."""
    found, crossed = chosen.found, CrossValidated(problem, chosen.found.dispersion)
    before, after = (crossed.rms(one) for one in (bare(found), found))
    findings = _findings(problem, chosen, crossed)
    refuted = bool(chosen.rejected and not findings)
    unseen = not findings and _unseen(problem, found, crossed.launches)
    lost = found.lost or refuted or unseen or (found.doubtful is not None and not findings)
    return Account(
        problem.regime,
        findings,
        {name: found.final.estimate(name) for name in problem.base},
        found.shipped and not findings and not lost,
        Proof(problem.noise_m * before, problem.noise_m * after, problem.noise_m, len(crossed.launches)),
        undetermined=LOST if lost else "",
        next_recording=advice(problem, found, findings, found.clusters),
        doubt=_doubt(chosen),
        minor=_minor(problem.regime, chosen),
        lost=lost,
        better=len(crossed.launches) >= ENOUGH
        and crossed.left(bare(found)).sum() < crossed.left(_unfitted(problem, found, shipped)).sum(),
    )


def _unfitted(problem: Problem, found: Explained, shipped: Mapping[str, float]) -> Explained:
    """The simulator's own numbers as they are."""
    return replace(bare(found), law=given({**found.baseline.values, **shipped}))


def _unseen(problem: Problem, found: Explained, launches: np.ndarray) -> bool:
    """Whether far more than noise is left of the launches; single bounces may be odd."""
    left = soft_loss(problem, problem.residuals(found.law.values, (), launches))[0]
    return left > MUCH**2 * max(float(problem.freedom[launches].sum()), 1.0)


def _findings(problem: Problem, chosen: Selected, crossed: CrossValidated) -> tuple[Finding, ...]:
    """All findings; those first without which most is lost."""
    found = chosen.found
    if not found.model.laws:
        return ()
    lost = {law.name: crossed.rms(chosen.without[law.name]) for law in found.model.laws}
    tried = np.isin(found.clusters, crossed.launches[FOLDS - 1 :: FOLDS])
    parts = (found.clusters[~tried], found.clusters[tried])
    controls = twins(found.screen.grams, problem.units, found.model, found.screen.listed, *parts)
    ordered = sorted(found.model.laws, key=lambda law: -lost[law.name])
    told = [_unlisted(problem, found, law) if law.family else _listed(found, law) for law in ordered]
    return tuple(replace(one, twins=controls) for one in told)


def _listed(found: Explained, law: Law) -> Finding:
    effect, fitted = EFFECTS[law.name], found.final
    own = {name: value for name, value in law.start.items() if name in law.rows}
    own |= {name: fitted.values[name] for name in law.rows if name in fitted.free}
    also, rivals = compare(found.chooser, found.model, law, found.screen)
    return Finding(
        effect.regime, law.name, also, effect.depends_on, effect.law, labelled(law, fitted),
        chance(found.chooser, found.model, law, found.screen), where=whereabouts(law, fitted.values), values=own,
        ranges={name: fitted.estimate(name) for name in law.rows if name in fitted.free}, rivals=rivals,
    )  # fmt: skip


def _unlisted(problem: Problem, found: Explained, law: Law) -> Finding:
    also, rivals = compare(found.chooser, found.model, law, found.screen)
    return Finding(
        problem.regime, law.mechanism, also, (law.family,), law.name, _sizes(found, law),
        chance(found.chooser, found.model, law, found.screen), values=found.switched(), rivals=rivals,
    )  # fmt: skip


def _sizes(found: Explained, law: Law) -> Mapping[str, Estimate]:
    """The coefficients of a smooth law with their intervals."""
    near = reach_of_launches(found.law.clusters) * np.sqrt(np.diag(found.theta_covariance))
    return {
        f"c{i}": Estimate(float(value), float(value - half), float(value + half), "1")
        for i, (value, half) in enumerate(zip(found.coefficients, near[-len(law.columns) :], strict=True))
    }


def _minor(regime: str, chosen: Selected) -> str:
    laws = [f"{name} is there, but moves things by {1e3 * size:.2g} mm" for name, size in chosen.small.items()]
    return f"{'; '.join(laws)}; less than {1e3 * LEAST[regime]:g} mm is not reported" if laws else ""


def _doubt(chosen: Selected) -> str:
    found = chosen.found
    if chosen.rejected:
        names, others = (" and ".join(law.name for law in laws) for laws in (chosen.rejected, chosen.others))
        beside = f"; beside that, {others} leaves most unexplained" if others else ""
        return f"{names} would fit, but launches that it was not fitted to do not bear it out{beside}"
    if found.doubtful is None:
        return ""
    return f"{found.doubtful.name} would fit, but what asks for it is in too few launches to tell it from an accident"
