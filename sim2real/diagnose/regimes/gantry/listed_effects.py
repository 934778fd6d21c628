"""Fit listed effects to the mallet's path, each by nonlinear least squares together with the baseline.

The encoders are so precise that no effect is a small perturbation. The column of an effect is therefore the difference
of the residuals between the best fits without and with it. Further effects are tried in addition to the best one while
misfit remains.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import repeat

import numpy as np

from puckpilot_env.parameters import BY_NAME
from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine.least_squares import LeastSquaresFit, fit
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.tuned import ENGINE
from sim2real.diagnose.regimes.gantry.residuals import LOW_ORDER, GantryResiduals
from sim2real.diagnose.regimes.gantry.tuned import GANTRY_FIT

# Starting values of an effect; of several, those with the smallest linearised loss are fitted
STARTS: dict[str, tuple[dict[str, float], ...]] = {
    "voltage_sag": ({}, {"voltage_sag": 0.02}),
    "motor_deadband": ({},),
    "motor_friction": ({},),
    "command_delay": tuple({"command_delay": late} for late in (0.002, 0.01, 0.03)),
    "belt_compliance": tuple({"belt_hz": hz, "belt_zeta": 0.15} for hz in (5.0, 8.0, 12.0, 18.0, 28.0, 42.0)),
    "backlash": tuple({"backlash_gap": gap} for gap in (2e-4, 7e-4, 2e-3)),
    "clock_drift": tuple({"encoder_clock": ppm} for ppm in (-1000.0, -300.0, 300.0, 1000.0)),
}
ALTERNATIVES = {"belt_compliance": "backlash", "backlash": "belt_compliance"}  # both make the mallet lag its motor
ONCE = 1  # step of a fit that only estimates the covariance


@dataclass(frozen=True)
class StagedFit:
    """A law fitted in two stages: `low_order` with the jerk's coefficients at their defaults, then `law` with them
    free.

    If these coefficients were free from the start, they would absorb any other effect that delays or smooths the path.
    """

    low_order: LeastSquaresFit
    law: LeastSquaresFit


@dataclass(frozen=True)
class Candidate:
    """An effect in addition to those in `beside`: its best fit `law`, and the `column` (n,) of residual changes."""

    name: str
    beside: tuple[str, ...]
    law: LeastSquaresFit
    column: np.ndarray

    @property
    def label(self) -> str:
        """A name for the column that differs from all parameters' names."""
        return " beside ".join((f"+ {self.name}", *self.beside))


def candidates(problem: GantryResiduals, values: Mapping[str, float]) -> list[Candidate]:
    """The effects that fits from `values` support; if the best of them leave much of the baseline's excess, only one
    that explains far more than any other, or none.

    An effect is not supported if its fit ends at a bound of its range or its size is not significant.
    """
    thin = problem.thinned(GANTRY_FIT.samples)
    freedom = float(thin.freedom.sum())
    now = base = _fit_in_stages(thin, [values], ())
    chosen: tuple[str, ...] = ()
    found: list[Candidate] = []
    dominant = ""
    while len(chosen) < GANTRY_FIT.most_effects and now.law.loss > GANTRY_FIT.little_left * freedom:
        fits = _supported_fits(thin, now, chosen)
        if not fits:
            break
        best = min(fits, key=lambda name: fits[name].law.loss)
        fits[best] = _converged(thin, fits[best], freedom)
        if not is_supported(thin, now.law, fits[best].law, best):
            break
        share = GANTRY_FIT.later_share if chosen else GANTRY_FIT.first_share
        if now.law.loss - fits[best].law.loss < share * (now.law.loss - freedom):
            best = "" if chosen else _first_of_pair(thin, fits)
            if not best:
                break
        if not chosen and _stands_out(fits, best, now.law.loss - freedom, freedom):
            dominant = best
        before = _residuals(problem, now.law)
        found += [Candidate(name, chosen, one.law, _residuals(problem, one.law) - before) for name, one in fits.items()]
        chosen, now = (*chosen, best), fits[best]
    before, after = (_mean_square(problem, one.law) for one in (base, now))  # all samples: backlash shows in reversals
    much = after > GANTRY_FIT.much_left and after - 1.0 > (1.0 - GANTRY_FIT.later_share) * (before - 1.0)
    return [one for one in found if one.name == dominant and not one.beside] if much else found


def _supported_fits(problem: GantryResiduals, now: StagedFit, chosen: tuple[str, ...]) -> dict[str, StagedFit]:
    """The fits, by name, of the further effects beside those `chosen`, fitted as `now`, that the data support."""
    names = [name for name in STARTS if name not in chosen and ALTERNATIVES.get(name) not in chosen]
    with ThreadPoolExecutor() as pool:
        fits = dict(zip(names, pool.map(best_fit, repeat(problem), repeat(now), names), strict=True))
    return {name: one for name, one in fits.items() if is_supported(problem, now.law, one.law, name)}


def _first_of_pair(problem: GantryResiduals, fits: Mapping[str, StagedFit]) -> str:
    """The first effect of a pair that explains nearly all of the excess though each alone explains little; "" if there
    is none."""
    freedom = float(problem.freedom.sum())
    for first in sorted(fits, key=lambda name: fits[name].law.loss)[: GANTRY_FIT.firsts]:
        pairs = _supported_fits(problem, fits[first], (first,))
        little = (1.0 - GANTRY_FIT.later_share) * (fits[first].law.loss - freedom)  # as a further effect has to leave
        if any(one.law.loss - freedom < little for one in pairs.values()):
            return first
    return ""


def _stands_out(fits: Mapping[str, StagedFit], best: str, excess: float, freedom: float) -> bool:
    """Whether the best effect explains most of the `excess`, and leaves far less of it than each of the others."""
    left = fits[best].law.loss - freedom
    others = [one.law.loss - freedom for name, one in fits.items() if name != best]
    return left < (1.0 - GANTRY_FIT.most_share) * excess and left < GANTRY_FIT.far_less * min([excess, *others])


def is_supported(problem: GantryResiduals, without: LeastSquaresFit, law: LeastSquaresFit, name: str) -> bool:
    """Whether the fit `law` of an effect lies inside its range, is significant, and improves more than by chance."""
    rows = EFFECTS[name].row_names
    if set(law.bound) & set(rows):
        return False
    sizes = [abs(law.values[row] - BY_NAME[row].default) > GANTRY_FIT.significance * _std(law, row) for row in rows]
    by_starts = 4.0 * problem.windows if name == "belt_compliance" else 0.0  # two ringing columns on each axis
    noise = max(law.loss / float(problem.freedom.sum()), 1.0)
    return any(sizes) and (without.loss - law.loss) / noise > ENGINE.fit_gain + 2.0 * len(rows) + by_starts


def best_fit(problem: GantryResiduals, without: StagedFit, name: str) -> StagedFit:
    """The best fit of an effect in addition to others, with all their parameters free."""
    rows = (*(row for row in without.low_order.free if row not in problem.base), *EFFECTS[name].row_names)
    starts = [{**without.low_order.values, **start} for start in STARTS[name]]
    if len(starts) > GANTRY_FIT.followed:
        starts.sort(key=lambda start: linearised_loss(problem, start, (*LOW_ORDER, *rows)))
    return _fit_in_stages(problem, starts[: GANTRY_FIT.followed], rows)


def _fit_in_stages(problem: GantryResiduals, starts: Sequence[Mapping[str, float]], rows: tuple[str, ...]) -> StagedFit:
    """The best low-order fit from `starts`, followed by the fit of all parameters."""
    low_order = [fit(problem, start, (*LOW_ORDER, *rows), problem.everything, GANTRY_FIT.rounds) for start in starts]
    best = min(low_order, key=lambda one: one.loss)
    if "command_delay" in rows:
        best = _delay_in_steps(problem, best)
    return StagedFit(best, fit(problem, best.values, (*problem.base, *rows), problem.everything, GANTRY_FIT.rounds))


def _converged(problem: GantryResiduals, one: StagedFit, freedom: float) -> StagedFit:
    """Both fits continued while that reduces their excess over the noise, of `freedom`: friction and
    another effect correlate, so that convergence is slow."""
    low_order, law = _continued(problem, one.low_order, freedom), one.law
    if low_order.loss < law.loss:  # the fit of all parameters had ended elsewhere
        law = fit(problem, low_order.values, law.free, problem.everything, GANTRY_FIT.rounds)
    return StagedFit(low_order, _continued(problem, law, freedom))


def _continued(problem: GantryResiduals, law: LeastSquaresFit, freedom: float) -> LeastSquaresFit:
    for _ in range(GANTRY_FIT.continued):
        more = fit(problem, law.values, law.free, problem.everything, GANTRY_FIT.rounds)
        better = more.loss - freedom < GANTRY_FIT.still_better * (law.loss - freedom)
        law = min(law, more, key=lambda each: each.loss)
        if not better:
            break
    return law


def _delay_in_steps(problem: GantryResiduals, law: LeastSquaresFit) -> LeastSquaresFit:
    """The fit with the best delay on a grid near the fitted one; with ticks, the effect of a delay is discontinuous."""
    tick = max(run.drive_inputs.tick for run in problem.runs)
    free = tuple(row for row in law.free if row != "command_delay")
    delays = [max(law.values["command_delay"] + share * tick, 0.0) for share in GANTRY_FIT.delay_steps]
    starts = [{**law.values, "command_delay": delay} for delay in delays]
    if not tick:
        return law
    best = min(starts, key=lambda start: linearised_loss(problem, start, free))
    values = fit(problem, best, free, problem.everything, GANTRY_FIT.rounds).values
    return fit(problem, values, law.free, problem.everything, ONCE)


def _std(law: LeastSquaresFit, row: str) -> float:
    k = law.free.index(row)
    return float(np.sqrt(law.covariance[k, k]))


def _mean_square(problem: GantryResiduals, law: LeastSquaresFit) -> float:
    """Mean square residual in units of the noise."""
    r = problem.residuals(law.values, (), problem.everything).r
    return float(r @ r) / float(problem.freedom.sum())


def _residuals(problem: GantryResiduals, law: LeastSquaresFit) -> np.ndarray:
    return problem.residuals(law.values, (), np.arange(problem.clusters)).r


def linearised_loss(problem: GantryResiduals, start: Mapping[str, float], free: Sequence[str]) -> float:
    """The least loss with the parameters `free`, from the linearisation at `start`."""
    found = problem.residuals(start, free, problem.everything)
    sums = normal_equations.make_equations(free, found.r, found.jacobian, found.cluster, problem.clusters)
    columns = np.arange(len(free))
    theta = normal_equations.solve(sums, columns, problem.everything)
    return float(normal_equations.losses(sums, columns, theta, problem.everything).sum())
