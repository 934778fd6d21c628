"""Identification of one regime: search for laws, cross-validation over launches, effect sizes, and the result."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sim2real.diagnose.consistency import check_consistency
from sim2real.diagnose.effect_size import effect_size
from sim2real.diagnose.engine.cross_validation import Selection, select
from sim2real.diagnose.engine.model_search import without, without_laws
from sim2real.diagnose.engine.problem import Problem
from sim2real.diagnose.profile_likelihood import with_profiles
from sim2real.diagnose.regimes.base import TOO_LITTLE, Evidence, IdentifiedRegime, Known, Regime
from sim2real.diagnose.result.regime_result import regime_result
from sim2real.diagnose.result.result import RegimeResult
from sim2real.diagnose.tuned import IDENTIFICATION


def identify_regime(regime: Regime, problem: Problem, evidence: Evidence, known: Known) -> IdentifiedRegime:
    """Identify what a regime lacks from its `problem`, given the regimes `known` before it.

    If those have a misfit and large residuals remain here too, no law is named.
    """
    live = np.flatnonzero(problem.freedom > 0)
    if len(live) < IDENTIFICATION.fewest_launches or problem.freedom[live].sum() < IDENTIFICATION.fewest_residuals:
        return IdentifiedRegime(problem, RegimeResult(regime.name, (), {}, False, None, TOO_LITTLE, regime.more))
    clear, premises_hold = regime.premises(evidence, known)
    values = regime.parameters(evidence, known)
    defaults = {name: values[name] for name in problem.base}
    problem, found = regime.search(problem, defaults, live, clear)
    # of what the search leaves of scatter: the noise of a camera alone would make two tables of one with rough walls
    check_consistency(problem, defaults, regime.parts(problem, evidence, known))
    chosen = _drop_small_laws(regime, problem, select(problem, found, premises_hold))
    chosen = _with_profiles(regime, problem, chosen)
    result = regime_result(regime, problem, chosen, defaults)
    if not premises_hold and (result.unexplained or result.misfit):
        chosen = Selection(chosen.cross_validation, without_laws(chosen.found), {})
        result = regime_result(regime, problem, chosen, defaults)
        result = replace(result, undetermined=f"it depends on {regime.premise}", misfit=False)
    elif (result.misfit or result.unexplained) and not result.next_recording:
        result = replace(result, next_recording=regime.more)
    result = replace(result, doubt="; ".join(filter(None, (result.doubt, regime.note(problem)))))
    explained = (
        found.unlisted is None and not found.misfit
    )  # of the search: a law that was rejected later leaves a doubt
    return _illustrated(regime, IdentifiedRegime(problem, result, chosen.found, chosen.without, explained))


def _with_profiles(regime: Regime, problem: Problem, chosen: Selection) -> Selection:
    """The selection with the intervals of parameters in which predictions are not smooth, unless a smooth term, which
    takes up what differs, is beside them."""
    found = chosen.found
    if not regime.nonsmooth or found.unlisted is not None:
        return chosen
    return replace(
        chosen, found=replace(found, law=with_profiles(problem, found.law, regime.nonsmooth, found.clusters))
    )


def _illustrated(regime: Regime, one: IdentifiedRegime) -> IdentifiedRegime:
    """Return the regime with the findings' curves, formulas and sizes [m], and with its mismatch."""
    problem, found = one.problem, one.final
    assert problem is not None and found is not None
    sizes = [effect_size(regime, problem, found, one.without[name]) for name in one.laws]
    findings = tuple(
        replace(regime.illustrated(problem, found, finding, found.clusters), size_m=size)
        for finding, size in zip(one.regime_result.findings, sizes, strict=True)
    )
    mismatch = regime.mismatch(problem, found)
    return replace(one, regime_result=replace(one.regime_result, findings=findings, mismatch=mismatch))


def _drop_small_laws(regime: Regime, problem: Problem, chosen: Selection) -> Selection:
    """Remove the laws whose effect is smaller than the regime reports, the smallest first."""
    while chosen.found.model.laws:
        sizes = {
            one.name: effect_size(regime, problem, chosen.found, chosen.without[one.name])
            for one in chosen.found.model.laws
        }
        name, size = min(sizes.items(), key=lambda one: one[1])
        if size >= regime.least_size:
            break
        found = chosen.without[name]
        rest = {one.name: without(problem, found, one) for one in found.model.laws}
        chosen = replace(chosen, found=found, without=rest, small={**chosen.small, name: size})
    return chosen
