"""Joint nonlinear fits: backward elimination of negligible laws, outlying launches, tests for a remaining misfit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.stats import chi2

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine.law import Law, Model
from sim2real.diagnose.engine.least_squares import LeastSquaresFit, fit, robust_loss
from sim2real.diagnose.engine.problem import DesignMatrix, Problem
from sim2real.diagnose.engine.tuned import ENGINE
from sim2real.diagnose.tuned import RESIDUALS
from sim2real.statistics.robust import group_threshold


def refit(
    problem: Problem, baseline: LeastSquaresFit, listed: Sequence[Law], screen: DesignMatrix, use: np.ndarray
) -> LeastSquaresFit:
    """Fit the baseline and the `listed` laws jointly to the clusters `use`, adding one law at a time.

    A nonlinear law starts from the best of its starts in the design matrix `screen`; and once more beside the laws that
    were added after it, without which it may have settled far off.
    """
    best = baseline
    for law in listed:
        free = tuple(dict.fromkeys((*best.free, *law.rows)))
        best = fit(problem, _best_start(problem, best, law, free, screen, use), free, use)
    for law in listed[:-1]:
        if law.start:
            again = fit(problem, _best_start(problem, best, law, best.free, screen, use), best.free, use)
            best = min(best, again, key=lambda one: one.loss)
    return best


def _best_start(
    problem: Problem, best: LeastSquaresFit, law: Law, free: Sequence[str], screen: DesignMatrix, use: np.ndarray
) -> Mapping[str, float]:
    """The values from which a joint fit with a law begins, the others as in the `best` fit so far."""
    if not law.start:
        return best.values
    defaults = {name: BY_NAME[name].default for name in law.rows}
    starts = [{**best.values, **defaults, **one.start} for one in screen.listed if one.name == law.name]
    tries = [fit(problem, start, free, use, ENGINE.exploring_rounds) for start in starts]
    return min(tries, key=lambda one: one.loss).values


def eliminated(
    problem: Problem, baseline: LeastSquaresFit, model: Model, screen: DesignMatrix, use: np.ndarray
) -> tuple[Model, LeastSquaresFit]:
    """Remove the listed laws whose size in the joint fit is not significant, the smallest first.

    Returns the remaining model and its joint fit.
    """
    while True:
        listed = [law for law in model.laws if not law.family]
        fitted = refit(problem, baseline, listed, screen, use)
        sizes = [_size(problem, fitted, law, use) for law in listed]
        if not sizes or min(sizes) > ENGINE.wald_size:
            return model, fitted
        model = model.minus(listed[int(np.argmin(sizes))])


def _size(problem: Problem, fitted: LeastSquaresFit, law: Law, use: np.ndarray) -> float:
    """Return the significance of a law in a joint fit, a chi-square statistic.

    It is the smaller of the Wald statistic d' C^-1 d, with d the parameters minus their defaults, and the increase of
    the loss with these parameters at default. For a law with a `start`, such as friction that always grips, it is the
    increase of the loss after a refit of all else: its parameters may be undetermined although the law is significant.
    """
    rows = [name for name in law.rows if name in fitted.free]
    defaults = {name: BY_NAME[name].default for name in rows}
    if law.start:
        others = [name for name in fitted.free if name not in rows]
        return fit(problem, {**fitted.values, **defaults}, others, use).loss - fitted.loss
    without, _ = robust_loss(problem, problem.residuals({**fitted.values, **defaults}, (), use))
    at = [fitted.free.index(name) for name in rows]
    deviation = np.array([fitted.values[name] - defaults[name] for name in rows])
    wald = float(deviation @ np.linalg.pinv(fitted.covariance[np.ix_(at, at)], hermitian=True) @ deviation)
    return min(wald, without - fitted.loss)


def has_misfit(problem: Problem, baseline: LeastSquaresFit, law: LeastSquaresFit, use: np.ndarray) -> bool:
    """Return whether the residuals show that a law is still missing.

    The baseline alone has a misfit if the residuals of a typical launch (a typical unit, if single units may be
    outliers) or of many launches are far beyond noise. Listed laws have one if a typical launch is beyond noise, by a
    large share of the baseline's misfit. The noise of a calibrated camera may be larger by `RESIDUALS.as_noise`, since
    places have larger errors where the puck's outline crosses a line.
    """
    noise_factor = RESIDUALS.as_noise**2 if problem.place_error_m else 1.0
    before, after = (_typical(problem, one, use) - 1.0 for one in (baseline, law))
    if law is baseline:
        return after > ENGINE.misfit or _beyond_noise(problem, law, use, noise_factor).mean() > ENGINE.misfit_launches
    return after > ENGINE.misfit_beside_laws and after > min(ENGINE.misfit_left * before, ENGINE.misfit)


def fits_typical_launch(problem: Problem, law: LeastSquaresFit, use: np.ndarray) -> bool:
    """Return whether the residuals of a typical launch are noise."""
    return _typical(problem, law, use) - 1.0 <= ENGINE.misfit_beside_laws


def explains_nearly_all(problem: Problem, baseline: LeastSquaresFit, law: LeastSquaresFit, use: np.ndarray) -> bool:
    """Return whether the remaining residuals of listed laws are too small to require another law.

    They are if their excess over the noise is a small share of the baseline's and of the noise, and if at most one
    launch, which may be an outlier, is beyond noise.
    """
    noise = float(problem.freedom[use].sum())
    enough = min(ENGINE.negligible_share * (baseline.loss - noise), ENGINE.negligible_noise * noise)
    return law is not baseline and law.loss - noise < enough and _beyond_noise(problem, law, use).sum() <= 1


def defaults_accepted(
    problem: Problem, defaults: Mapping[str, float], baseline: LeastSquaresFit, use: np.ndarray, dispersion: float
) -> bool:
    """Return whether a likelihood-ratio test accepts the simulator's default parameters.

    The statistic is the loss of the defaults minus that of the refit, divided by the dispersion: a chi-square with one
    degree of freedom per parameter of the baseline.
    """
    loss, _ = robust_loss(problem, problem.residuals(defaults, (), use))
    statistic = (loss - baseline.loss) / dispersion
    return bool(chi2.sf(max(statistic, 0.0), len(problem.base)) > ENGINE.default_p)


def without_leverage(
    problem: Problem, baseline: LeastSquaresFit, use: np.ndarray
) -> tuple[np.ndarray, LeastSquaresFit]:
    """Return the clusters `use` without a few outliers of high leverage, and the baseline fitted to the rest.

    Such a launch has far larger residuals than the others, and its deletion removes the misfit of a typical launch.
    """
    kept = use
    for _ in range(max(int(ENGINE.outlying_share * len(use)), 1)):
        misfits = reduced_chi_squares(problem, baseline, kept)
        typical, worst = float(np.median(misfits)), int(np.argmax(misfits))
        if typical < ENGINE.leverage_median or misfits[worst] < ENGINE.leverage_excess * typical:
            break
        fewer = np.delete(kept, worst)
        without = fit(problem, baseline.values, problem.base, fewer)
        if np.median(reduced_chi_squares(problem, without, fewer)) > ENGINE.leverage_decrease * typical:
            break
        kept, baseline = fewer, without
    return kept, baseline


def without_outliers(problem: Problem, law: LeastSquaresFit, use: np.ndarray) -> np.ndarray:
    """Return the clusters `use` without the few outliers that the final law does not explain."""
    misfits = reduced_chi_squares(problem, law, use)
    outlying = misfits > ENGINE.outlying_excess * max(float(np.median(misfits)), 1.0)
    return use[~outlying] if outlying.sum() <= ENGINE.outlying_share * len(use) else use


def reduced_chi_squares(problem: Problem, law: LeastSquaresFit, use: np.ndarray) -> np.ndarray:
    """Return the reduced chi-square (use,) of each cluster under a law, in units of the noise."""
    found = problem.residuals(law.values, (), use)
    return np.bincount(found.cluster, found.r**2, problem.clusters)[use] / np.maximum(problem.freedom[use], 1.0)


def _beyond_noise(problem: Problem, law: LeastSquaresFit, use: np.ndarray, noise_factor: float = 1.0) -> np.ndarray:
    """Return which launches (n,) bool have residuals beyond noise of `noise_factor` times the variance."""
    known = problem.freedom[use] > 0.0
    freedom = problem.freedom[use][known]
    return reduced_chi_squares(problem, law, use)[known] * freedom > noise_factor * group_threshold(freedom)


def _typical(problem: Problem, law: LeastSquaresFit, use: np.ndarray) -> float:
    """Return the median reduced chi-square over launches.

    If single units may be outliers, it is the median over units of the sum of squares divided by its median under
    noise.
    """
    found = problem.residuals(law.values, (), use)
    if found.unit is None:
        return float(np.median(reduced_chi_squares(problem, law, use)))
    units = np.unique(found.unit)
    return float(np.median(np.bincount(found.unit, found.r**2)[units] / chi2.median(problem.units.freedom[units])))
