"""Laws fitted together, and what then stands: which come to nothing, what they leave, and of which launches."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.stats import chi2

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import Model
from sim2real.diagnose.engine.fit import Fit, fit, soft_loss
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.finding import TO_THE_NOISE
from sim2real.diagnose.problem import Columns, Problem

CLEAR = 1e-4  # chance at which the simulator's own numbers would be refused though they are right
FAR_OFF = 2.0  # mean square residual beyond 1 of a typical launch, in units of the noise, that nothing explains
WORTHWHILE = 0.1  # share of what the baseline leaves that must remain to be worth a law
AUDIBLE = 1.0  # of the noise, in variance, that must remain to be worth a law in any case
MANY_ASTRAY = 0.25  # of the launches: more than accidents, such as touches that nobody saw, spoil
NEAR, HALF_WAY = 0.3, 0.3  # the same beside listed laws, and as a share of what the baseline leaves
STRAY = 6.0  # times the usual sum of squares: a launch in which something else happened
MOST_STRAY = 0.1  # of the launches, that may be left out
SPOILT, OUTSHINES = 1.5, 30.0  # mean square residual of a typical launch, and times that, of one that spoils the rest
LEAST_SIZE = 20.0  # sum of squares by which a law must stand out of the final fit
FEW_ROUNDS = 4  # of a fit, to see which start leads farthest


def far_off(problem: Problem, baseline: Fit, law: Fit, use: np.ndarray) -> bool:
    """Whether something must be missing still: a bare baseline leaves far more than noise of most launches (of most
    units, where single ones may be wrong altogether) or of many; or listed laws do, or leave much of what it does. What
    a calibrated camera saw is noise up to TO_THE_NOISE: where a puck's outline crosses a line, it errs more."""
    noisy = TO_THE_NOISE**2 if problem.place_error_m else 1.0
    before, after = (_typical(problem, one, use) - 1.0 for one in (baseline, law))
    if law is baseline:
        return after > FAR_OFF or float(_astray(problem, law, use, noisy).mean()) > MANY_ASTRAY
    return after > NEAR and after > min(HALF_WAY * before, FAR_OFF)


def _astray(problem: Problem, law: Fit, use: np.ndarray, noisy: float = 1.0) -> np.ndarray:
    """The launches (n,) bool of which a law leaves what noise, `noisy` times as large, alone hardly ever does."""
    seen = problem.freedom[use] > 0.0
    freedom = problem.freedom[use][seen]
    return left_of(problem, law, use)[seen] * freedom > noisy * gram.soft_from(freedom)


def nearly_all(problem: Problem, baseline: Fit, law: Fit, use: np.ndarray) -> bool:
    """Whether listed laws explain so much that what they leave is not worth a law of its own: little of what there was,
    and little beside the noise, of all launches but one that may have met an accident."""
    noise = float(problem.freedom[use].sum())
    enough = min(WORTHWHILE * (baseline.loss - noise), AUDIBLE * noise)
    return law is not baseline and law.loss - noise < enough and _astray(problem, law, use).sum() <= 1


def left_of(problem: Problem, law: Fit, use: np.ndarray) -> np.ndarray:
    """What a law leaves of each cluster in `use`: its mean square residual in units of the noise."""
    found = problem.residuals(law.values, (), use)
    return np.bincount(found.cluster, found.r**2, problem.clusters)[use] / np.maximum(problem.freedom[use], 1.0)


def _typical(problem: Problem, law: Fit, use: np.ndarray) -> float:
    """What a law leaves of a typical launch or, where single units may be wrong altogether, of a typical unit: the mean
    square residual in units of the noise."""
    found = problem.residuals(law.values, (), use)
    if found.unit is None:
        return float(np.median(left_of(problem, law, use)))
    units = np.unique(found.unit)
    return float(np.median(np.bincount(found.unit, found.r**2)[units] / chi2.median(problem.units.freedom[units])))


def refit(problem: Problem, baseline: Fit, listed: Sequence[Law], screen: Columns, use: np.ndarray) -> Fit:
    """The nonlinear fit of the baseline and the listed laws together, from each place at which one was looked for."""
    best = baseline
    for law in listed:
        free = tuple(dict.fromkeys((*best.free, *law.rows)))
        values = {**best.values, **law.start}
        if law.start:
            starts = [one.start for one in screen.listed if one.name == law.name]
            tries = [fit(problem, {**values, **start}, free, use, FEW_ROUNDS) for start in starts]
            values = min(tries, key=lambda one: one.loss).values
        best = fit(problem, values, free, use)
    return best


def standing(problem: Problem, baseline: Fit, model: Model, screen: Columns, use: np.ndarray) -> tuple[Model, Fit]:
    """The model without listed laws that come to nothing when all are fitted together, and that fit."""
    while True:
        listed = [law for law in model.laws if not law.family]
        fitted = refit(problem, baseline, listed, screen, use)
        sizes = [_size(problem, fitted, law, use) for law in listed]
        if not sizes or min(sizes) > LEAST_SIZE:
            return model, fitted
        model = model.minus(listed[int(np.argmin(sizes))])


def _size(problem: Problem, fitted: Fit, law: Law, use: np.ndarray) -> float:
    """How surely a law is there: the squares of its numbers by their covariance, or what the sum of squares grows by
    without them, if that is less. A nonlinear law may be sure though its numbers are not, such as a friction that
    always grips: of it, what the sum of squares grows by when all else is fitted without it."""
    rows = [name for name in law.rows if name in fitted.free]
    off = {name: BY_NAME[name].default for name in rows}
    if law.start:
        others = [name for name in fitted.free if name not in rows]
        return fit(problem, {**fitted.values, **off}, others, use).loss - fitted.loss
    without, _ = soft_loss(problem, problem.residuals({**fitted.values, **off}, (), use))
    at = [fitted.free.index(name) for name in rows]
    away = np.array([fitted.values[name] - off[name] for name in rows])
    surely = float(away @ np.linalg.pinv(fitted.covariance[np.ix_(at, at)], hermitian=True) @ away)
    return min(surely, without - fitted.loss)


def undisturbed(problem: Problem, baseline: Fit, use: np.ndarray) -> tuple[np.ndarray, Fit]:
    """The clusters without a few that alone pull the baseline away from all others, and the baseline without them."""
    kept = use
    for _ in range(max(int(MOST_STRAY * len(use)), 1)):
        left = left_of(problem, baseline, kept)
        typical, worst = float(np.median(left)), int(np.argmax(left))
        if typical < SPOILT or left[worst] < OUTSHINES * typical:
            break
        fewer = np.delete(kept, worst)
        without = fit(problem, baseline.values, problem.base, fewer)
        if np.median(left_of(problem, without, fewer)) > 0.5 * typical:
            break
        kept, baseline = fewer, without
    return kept, baseline


def calm_clusters(problem: Problem, law: Fit, use: np.ndarray) -> np.ndarray:
    """The clusters that the final law explains; a few that it does not saw something of their own, and are left out."""
    loss = left_of(problem, law, use)
    stray = loss > STRAY * max(float(np.median(loss)), 1.0)
    return use[~stray] if stray.sum() <= MOST_STRAY * len(use) else use


def as_shipped(problem: Problem, shipped: Mapping[str, float], baseline: Fit, use, dispersion: float) -> bool:
    """Whether the simulator's own numbers explain the recording as well as the refitted ones."""
    found, _ = soft_loss(problem, problem.residuals(shipped, (), use))
    worse = (found - baseline.loss) / dispersion
    return bool(chi2.sf(max(worse, 0.0), len(problem.base)) > CLEAR)
