"""Candidate models: listed laws, a smooth term in their place, or both; the simplest that predicts well is selected."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim2real.diagnose.engine.backward_elimination import eliminated, explains_nearly_all, has_misfit, refit
from sim2real.diagnose.engine.forward_selection import ForwardSelection, Gain
from sim2real.diagnose.engine.law import Law, Model
from sim2real.diagnose.engine.least_squares import LeastSquaresFit
from sim2real.diagnose.engine.nonparametric import NonparametricFit, fit_nonparametric
from sim2real.diagnose.engine.problem import DesignMatrix, Problem
from sim2real.diagnose.engine.tuned import ENGINE


@dataclass(frozen=True)
class CandidateModel:
    """A `model`, the fit of its listed laws, and the `smooth` term added to them, if any.

    `cv_loss`: cross-validation loss, linearized about the fit itself.
    """

    model: Model
    law: LeastSquaresFit
    smooth: NonparametricFit | None
    cv_loss: float

    @property
    def cost(self) -> int:
        """The complexity of the model: a listed law counts as one, a smooth term, which has a shape as well, as two."""
        return len(self.model.laws) + (self.smooth is not None)


def best_candidate(
    problem: Problem,
    baseline: LeastSquaresFit,
    law: LeastSquaresFit,
    listed: Model,
    selection: ForwardSelection,
    screen: DesignMatrix,
    terms: Sequence[Law],
    use: np.ndarray,
) -> CandidateModel:
    """Return the simplest of the candidates that predict well.

    Candidates are the `listed` laws, fitted as `law`; smooth terms alone, also with listed laws that are significant
    only beside them; and all or fewer of the listed laws with a smooth term for their remaining residuals. Smooth terms
    are tried only if the listed laws have a misfit or a significant remainder.

    `baseline`: fit without laws; `selection`: of the listed laws, in the design matrix `screen` about the baseline;
    `terms`: all smooth terms, of which the screen has the best variants beside the baseline alone.
    """
    only_listed = CandidateModel(listed, law, None, np.inf)
    baseline_loss = float(selection.cv_loss(Model(problem.base)).sum())
    rivalled = _rivalled(selection, listed, screen, baseline_loss)
    if not rivalled and explains_nearly_all(problem, baseline, law, use):
        return only_listed
    columns = screen
    if law is not baseline:
        columns = identifiable(problem.columns(law.values, law.free, None, terms), problem, use, law.free)
    refitted = ForwardSelection(columns.equations, problem.units, use, selection.dispersion, selection.least)
    remainder = _remainder(selection, listed, refitted, law, columns)
    if remainder is None and not rivalled and not has_misfit(problem, baseline, law, use):
        return only_listed
    candidates = [replace(only_listed, cv_loss=float(refitted.cv_loss(Model(law.free)).sum()))]
    gains = _promising_terms(selection, Model(problem.base), screen)
    if remainder is not None and not listed.laws and remainder.law.name not in {gain.law.name for gain in gains}:
        gains.append(remainder)
    alone = []
    for gain in gains:
        least = (
            baseline_loss - gain.fitted
        )  # a lower bound of the term's loss, as far as the linearization of the screen holds
        if least < min(one.cv_loss for one in (*candidates, *alone)):
            alone.append(_with_term(problem, Model(problem.base), baseline, gain, selection, use))
    if listed_suffice(candidates[0], alone, baseline_loss):
        candidates += [one for one in alone if one.smooth and one.smooth.family.is_simple]
    else:
        candidates += alone
        candidates += _term_with_laws(problem, baseline, gains, alone, selection, screen, use)
    if remainder is not None and listed.laws:
        candidates.append(_with_term(problem, listed, law, remainder, selection, use))
        fewer = selection.eliminate_backward(listed.plus(remainder.law, remainder.spread)).minus(remainder.law)
        if len(fewer.laws) < len(listed.laws) and fewer.laws:
            fewer, fitted = eliminated(problem, baseline, fewer, screen, use)
            candidates.append(_with_term(problem, fewer, fitted, remainder, selection, use))
    return simplest(candidates, baseline_loss)


def _rivalled(selection: ForwardSelection, listed: Model, screen: DesignMatrix, baseline_loss: float) -> bool:
    """Return whether a simple term alone predicts much better than the listed laws."""
    listed_loss = float(selection.cv_loss(listed).sum())
    gains = [selection.gain(Model(listed.base), law) for law in screen.families if law.is_simple]
    best = max((gain for gain in gains if selection.passes(gain)), key=lambda gain: gain.total, default=None)
    if best is None or not listed.laws:
        return False
    return listed_loss - (baseline_loss - best.total) > max(ENGINE.cv_gain, ENGINE.share_of_explained * best.total)


def simplest(candidates: Sequence[CandidateModel], baseline_loss: float) -> CandidateModel:
    """Return the candidate of least cost among those whose cross-validation loss is near the least.

    Near is within the least gain of a law, or a share of the reduction of the `baseline_loss` by the best candidate.
    """
    best = min(one.cv_loss for one in candidates)
    slack = max(ENGINE.cv_gain, ENGINE.share_of_explained * (baseline_loss - best))
    return min((one for one in candidates if one.cv_loss < best + slack), key=lambda one: (one.cost, one.cv_loss))


def listed_suffice(listed: CandidateModel, alone: Sequence[CandidateModel], baseline_loss: float) -> bool:
    """Return whether few listed laws explain most of what the best smooth term alone explains.

    If not, they may only approximate another law that the smooth term describes.
    """
    best = min((one.cv_loss for one in alone), default=np.inf)
    explained = baseline_loss - listed.cv_loss
    return 0 < len(listed.model.laws) <= ENGINE.few_listed and explained > ENGINE.sufficient * (baseline_loss - best)


def identifiable(columns: DesignMatrix, problem: Problem, use: np.ndarray, base: Sequence[str] = ()) -> DesignMatrix:
    """Return the design matrix without smooth terms that have too many coefficients for the data of the clusters `use`.

    Of variants that differ only in a size, the one that fits best beside the parameters `base` remains; by default
    `base` is the problem's.
    """
    most = float(problem.freedom[use].sum()) / ENGINE.residuals_per_coefficient
    selection = ForwardSelection(columns.equations, problem.units, use)
    found: dict[str, Law] = {}
    least: dict[str, float] = {}
    for law in columns.families:
        key = law.variant_of or law.name
        loss = 0.0
        if law.variant_of:
            loss = selection.fitted_loss(Model(tuple(base) or problem.base, (law,), (ENGINE.spreads[-1],)))
        if len(law.columns) <= most and loss < least.get(key, np.inf):
            found[key], least[key] = law, loss
    return replace(columns, families=list(found.values()))


def _term_with_laws(
    problem: Problem,
    baseline: LeastSquaresFit,
    gains: Sequence[Gain],
    alone: Sequence[CandidateModel],
    selection: ForwardSelection,
    screen: DesignMatrix,
    use: np.ndarray,
) -> list[CandidateModel]:
    """Return the best smooth term of those `alone` with listed laws that are significant only beside it.

    The list is empty if the term alone explains nearly everything.
    """
    best = min(alone, key=lambda one: one.cv_loss, default=None)
    baseline_loss = float(selection.cv_loss(Model(problem.base)).sum())
    if (
        best is None
        or best.smooth is None
        or best.cv_loss - selection.noise_loss < ENGINE.remainder * (baseline_loss - best.cv_loss)
    ):
        return []
    gain = next(gain for gain in gains if gain.law.name == best.smooth.family.name)
    term = Model(problem.base).plus(gain.law, gain.spread)
    grown = selection.eliminate_backward(selection.grow(term, screen.listed, ENGINE.joint_laws))
    if gain.law not in grown.laws or len(grown.laws) == 1:
        return []
    listed = grown.minus(gain.law)  # no elimination here: a law may be negligible without the term
    fitted = refit(problem, baseline, listed.laws, screen, use)
    return [_with_term(problem, listed, fitted, gain, selection, use)]


def _with_term(
    problem: Problem,
    listed: Model,
    law: LeastSquaresFit,
    gain: Gain,
    selection: ForwardSelection,
    use: np.ndarray,
) -> CandidateModel:
    """Return the listed laws, fitted as `law`, with the smooth term of a gain added."""
    smooth = fit_nonparametric(problem, law, gain.law, use, selection.dispersion)
    return CandidateModel(listed.plus(smooth.family, smooth.spread), smooth.law, smooth, smooth.cv_loss)


def _promising_terms(selection: ForwardSelection, base: Model, screen: DesignMatrix) -> list[Gain]:
    """Return the smooth terms that explain most by themselves, linearized about the baseline's trajectory.

    These are the terms that fit best by AIC and those that predict best.
    """
    gains = [gain for gain in (selection.gain(base, law) for law in screen.families) if selection.fits(gain)]
    predicting = sorted(gains, key=lambda gain: -gain.total)[: ENGINE.fitted_terms]
    fitting = sorted(gains, key=lambda gain: 2.0 * len(gain.law.columns) - gain.fitted)[: ENGINE.fitted_terms]
    return list({gain.law.name: gain for gain in (*fitting, *predicting)}.values())


def _remainder(
    selection: ForwardSelection,
    model: Model,
    refitted: ForwardSelection,
    law: LeastSquaresFit,
    columns: DesignMatrix,
) -> Gain | None:
    """Return the smooth term that best predicts the remaining residuals of the refitted listed laws.

    `law`: the refitted listed laws, `columns`: the design matrix about them. None if no term passes with a large enough
    gain.
    """
    gains = sorted((refitted.gain(Model(law.free), one) for one in columns.families), key=lambda gain: -gain.total)
    explained = float((selection.cv_loss(Model(model.base)) - selection.cv_loss(model)).sum())
    excess = refitted.fitted_loss(Model(law.free)) - refitted.noise_loss if model.laws else 0.0
    least = max(ENGINE.remainder * explained, ENGINE.remainder_of_excess * excess)
    return next((gain for gain in gains if refitted.passes(gain) and gain.total > least), None)
