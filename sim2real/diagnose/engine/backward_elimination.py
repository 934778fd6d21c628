"""Joint nonlinear fits: backward elimination of laws without size, outlying launches, and whether a misfit remains."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.stats import chi2

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine.law import Law, Model
from sim2real.diagnose.engine.least_squares import LeastSquaresFit, fit, robust_loss
from sim2real.diagnose.engine.problem import DesignMatrix, Problem
from sim2real.diagnose.engine.tuned import ENGINE
from sim2real.diagnose.result.result import TO_THE_NOISE
from sim2real.statistics.robust import group_threshold


def refit(
    problem: Problem, baseline: LeastSquaresFit, listed: Sequence[Law], screen: DesignMatrix, use: np.ndarray
) -> LeastSquaresFit:
    """Fit the baseline and the `listed` laws together to the clusters `use`, one law more each time; a nonlinear one
    from the best of its starts in the design matrix `screen`."""
    best = baseline
    for law in listed:
        free = tuple(dict.fromkeys((*best.free, *law.rows)))
        values = {**best.values, **law.start}
        if law.start:
            starts = [one.start for one in screen.listed if one.name == law.name]
            tries = [fit(problem, {**values, **start}, free, use, ENGINE.exploring_rounds) for start in starts]
            values = min(tries, key=lambda one: one.loss).values
        best = fit(problem, values, free, use)
    return best


def eliminated(
    problem: Problem, baseline: LeastSquaresFit, model: Model, screen: DesignMatrix, use: np.ndarray
) -> tuple[Model, LeastSquaresFit]:
    """Return the model without the listed laws that have no size in the joint fit, the smallest taken out first, and
    the joint fit of those that remain."""
    while True:
        listed = [law for law in model.laws if not law.family]
        fitted = refit(problem, baseline, listed, screen, use)
        sizes = [_size(problem, fitted, law, use) for law in listed]
        if not sizes or min(sizes) > ENGINE.wald_size:
            return model, fitted
        model = model.minus(listed[int(np.argmin(sizes))])


def _size(problem: Problem, fitted: LeastSquaresFit, law: Law, use: np.ndarray) -> float:
    """Significance of a law in a joint fit, a chi-square: the smaller of its Wald statistic d' C^-1 d, with d its
    parameters less their defaults, and of what the loss grows by with these at default. Of a law with a `start`, such
    as a friction that always grips, what the loss grows by when all else is refitted: its parameters may be
    undetermined though the law is certain."""
    rows = [name for name in law.rows if name in fitted.free]
    off = {name: BY_NAME[name].default for name in rows}
    if law.start:
        others = [name for name in fitted.free if name not in rows]
        return fit(problem, {**fitted.values, **off}, others, use).loss - fitted.loss
    without, _ = robust_loss(problem, problem.residuals({**fitted.values, **off}, (), use))
    at = [fitted.free.index(name) for name in rows]
    away = np.array([fitted.values[name] - off[name] for name in rows])
    wald = float(away @ np.linalg.pinv(fitted.covariance[np.ix_(at, at)], hermitian=True) @ away)
    return min(wald, without - fitted.loss)


def has_misfit(problem: Problem, baseline: LeastSquaresFit, law: LeastSquaresFit, use: np.ndarray) -> bool:
    """Whether something must be missing still. The baseline alone has a misfit where a typical launch (a typical unit,
    where single ones may be outliers) or many launches are far beyond noise; listed laws have one where a typical
    launch is beyond noise, and by no small part of what the baseline leaves. A calibrated camera's noise may be larger
    by TO_THE_NOISE: where a puck's outline crosses a line, it errs more."""
    noisy = TO_THE_NOISE**2 if problem.place_error_m else 1.0
    before, after = (_typical(problem, one, use) - 1.0 for one in (baseline, law))
    if law is baseline:
        return after > ENGINE.misfit or _beyond_noise(problem, law, use, noisy).mean() > ENGINE.misfit_launches
    return after > ENGINE.misfit_beside_laws and after > min(ENGINE.misfit_left * before, ENGINE.misfit)


def explains_nearly_all(problem: Problem, baseline: LeastSquaresFit, law: LeastSquaresFit, use: np.ndarray) -> bool:
    """Whether what listed laws leave is not worth a law of its own: it is little of what the baseline leaves beyond
    noise, little beside the noise, and not in launches beyond noise but one, which may have met an accident."""
    noise = float(problem.freedom[use].sum())
    enough = min(ENGINE.negligible_share * (baseline.loss - noise), ENGINE.negligible_noise * noise)
    return law is not baseline and law.loss - noise < enough and _beyond_noise(problem, law, use).sum() <= 1


def defaults_accepted(
    problem: Problem, defaults: Mapping[str, float], baseline: LeastSquaresFit, use: np.ndarray, dispersion: float
) -> bool:
    """Whether a likelihood-ratio test accepts the simulator's default parameters: what the loss grows by without the
    refit, divided by the dispersion, is a chi-square of as many degrees of freedom as the baseline has parameters."""
    loss, _ = robust_loss(problem, problem.residuals(defaults, (), use))
    worse = (loss - baseline.loss) / dispersion
    return bool(chi2.sf(max(worse, 0.0), len(problem.base)) > ENGINE.default_p)


def without_leverage(
    problem: Problem, baseline: LeastSquaresFit, use: np.ndarray
) -> tuple[np.ndarray, LeastSquaresFit]:
    """Return the clusters `use` without a few outliers of high leverage, and the baseline fitted to them. Such a
    launch leaves far more than the others, and when it is deleted, the misfit of a typical launch vanishes."""
    kept = use
    for _ in range(max(int(ENGINE.outlying_share * len(use)), 1)):
        left = reduced_chi_squares(problem, baseline, kept)
        typical, worst = float(np.median(left)), int(np.argmax(left))
        if typical < ENGINE.leverage_median or left[worst] < ENGINE.leverage_excess * typical:
            break
        fewer = np.delete(kept, worst)
        without = fit(problem, baseline.values, problem.base, fewer)
        if np.median(reduced_chi_squares(problem, without, fewer)) > ENGINE.leverage_decrease * typical:
            break
        kept, baseline = fewer, without
    return kept, baseline


def without_outliers(problem: Problem, law: LeastSquaresFit, use: np.ndarray) -> np.ndarray:
    """Return the clusters `use` without the few that the final law does not explain: something else happened there."""
    left = reduced_chi_squares(problem, law, use)
    outlying = left > ENGINE.outlying_excess * max(float(np.median(left)), 1.0)
    return use[~outlying] if outlying.sum() <= ENGINE.outlying_share * len(use) else use


def reduced_chi_squares(problem: Problem, law: LeastSquaresFit, use: np.ndarray) -> np.ndarray:
    """Sum of squares over degrees of freedom (use,) that a law leaves of each cluster, in units of the noise."""
    found = problem.residuals(law.values, (), use)
    return np.bincount(found.cluster, found.r**2, problem.clusters)[use] / np.maximum(problem.freedom[use], 1.0)


def _beyond_noise(problem: Problem, law: LeastSquaresFit, use: np.ndarray, noisy: float = 1.0) -> np.ndarray:
    """The launches (n,) bool of which a law leaves more than noise, `noisy` times as large in variance, hardly ever
    does."""
    known = problem.freedom[use] > 0.0
    freedom = problem.freedom[use][known]
    return reduced_chi_squares(problem, law, use)[known] * freedom > noisy * group_threshold(freedom)


def _typical(problem: Problem, law: LeastSquaresFit, use: np.ndarray) -> float:
    """Median reduced chi-square over launches or, where single units may be outliers, the median over units of the sum
    of squares in units of its own median under noise."""
    found = problem.residuals(law.values, (), use)
    if found.unit is None:
        return float(np.median(reduced_chi_squares(problem, law, use)))
    units = np.unique(found.unit)
    return float(np.median(np.bincount(found.unit, found.r**2)[units] / chi2.median(problem.units.freedom[units])))
