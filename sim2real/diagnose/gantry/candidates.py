"""Listed effects that the mallet's path may ask for, each fitted as it is, with the baseline beside it.

The mallet is followed so finely that no effect is a small change: its column is how the residuals differ between the
best fit without it and the best fit with it. On top of the best effect every other is tried, while anything is left.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from puckpilot_env.parameters import BY_NAME
from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import LEAST_FIT
from sim2real.diagnose.engine.fit import Fit, fit
from sim2real.diagnose.gantry.paths import PLAIN, GantryPaths

# where fits of an effect start; of several, the best looking by their derivatives are followed up
STARTS: dict[str, tuple[dict[str, float], ...]] = {
    "voltage_sag": ({},),
    "motor_deadband": ({},),
    "command_delay": tuple({"command_delay": late} for late in (0.002, 0.01, 0.03)),
    "belt_compliance": tuple({"belt_hz": hz, "belt_zeta": 0.15} for hz in (5.0, 8.0, 12.0, 18.0, 28.0, 42.0)),
    "backlash": tuple({"backlash_gap": gap} for gap in (2e-4, 7e-4, 2e-3)),
    "clock_drift": tuple({"encoder_clock": ppm} for ppm in (-1000.0, -300.0, 300.0, 1000.0)),
}
RIVALS = {"belt_compliance": "backlash", "backlash": "belt_compliance"}  # either gives between motor and mallet
FOLLOWED, ROUNDS = 2, 15  # starts of an effect that are fitted, and steps of each fit
ONCE = 1  # round: no step, only the spread of all that is free
SAMPLES = 3000  # for the fits of each effect; the chosen law is fitted anew to all
STEPS = tuple(0.125 * k for k in range(-8, 9))  # ticks, about a delay found by derivatives, at which it is tried
MOST = 3  # effects on top of each other
LITTLE_LEFT = 1.1  # mean square in units of the noise, at which nothing more is looked for
MUCH_LEFT = 2.0  # mean square at which the effects found must at least explain the share SHARE of what was left before
SHARE = 0.9  # of what was left before
LEAST_SHARE = 0.3  # of what was left before, that the first effect must explain; one on top of others: SHARE
SURE = 3.0  # standard deviations that an effect's size is from none


@dataclass(frozen=True)
class Staged:
    """A law fitted with the jerk's coefficients at the table's usual ones, `plain`, and then with them free, `law`.

    Free at once, they run off to stand for whatever else is late or soft.
    """

    plain: Fit
    law: Fit


@dataclass(frozen=True)
class Candidate:
    """An effect on top of those `beside` it; `law` is the best fit, `column` (n,) its change of the residuals."""

    name: str
    beside: tuple[str, ...]
    law: Fit
    column: np.ndarray

    @property
    def label(self) -> str:
        """A name for the column, unlike any parameter's."""
        return " beside ".join((f"+ {self.name}", *self.beside))


def candidates(problem: GantryPaths, values: Mapping[str, float]) -> list[Candidate]:
    """The effects that stand at a fit, started at `values`; none where the best leave much of what the baseline does.

    A law whose fit ends at a bound of its range, or whose size is not surely there, stands for something else.
    """
    thin = problem.thinned(SAMPLES)
    freedom = float(thin.freedom.sum())
    now = base = _staged(thin, [values], ())
    chain: tuple[str, ...] = ()
    found = []
    while len(chain) < MOST and now.law.loss > LITTLE_LEFT * freedom:
        names = [name for name in STARTS if name not in chain and RIVALS.get(name) not in chain]
        fits = {name: best_fit(thin, now, name) for name in names}
        fits = {name: one for name, one in fits.items() if stands(thin, now.law, one.law, name)}
        if not fits:
            break
        best = min(fits, key=lambda name: fits[name].law.loss)
        share = SHARE if chain else LEAST_SHARE
        if now.law.loss - fits[best].law.loss < share * (now.law.loss - freedom):
            break
        before = _all(problem, now.law)
        found += [Candidate(name, chain, one.law, _all(problem, one.law) - before) for name, one in fits.items()]
        chain, now = (*chain, best), fits[best]
    before, left = (
        _mean_square(problem, one.law) for one in (base, now)
    )  # of all samples: lost motion is in reversals
    return [] if left > MUCH_LEFT and left - 1.0 > (1.0 - SHARE) * (before - 1.0) else found


def stands(problem: GantryPaths, without: Fit, law: Fit, name: str) -> bool:
    """Whether an effect's fit `law` is inside its range, surely not at none, and better than chance would make it."""
    rows = EFFECTS[name].row_names
    if set(law.bound) & set(rows):
        return False
    sizes = [abs(law.values[row] - BY_NAME[row].default) > SURE * _std(law, row) for row in rows]
    spare = 4.0 * problem.windows if name == "belt_compliance" else 0.0  # its ringing starts free
    noise = max(law.loss / float(problem.freedom.sum()), 1.0)
    return any(sizes) and (without.loss - law.loss) / noise > LEAST_FIT + 2.0 * len(rows) + spare


def best_fit(problem: GantryPaths, without: Staged, name: str) -> Staged:
    """The best fit of an effect on top of others, all of whose parameters stay free."""
    rows = (*(row for row in without.plain.free if row not in problem.base), *EFFECTS[name].row_names)
    starts = [{**without.plain.values, **start} for start in STARTS[name]]
    if len(starts) > FOLLOWED:
        starts.sort(key=lambda start: promise(problem, start, (*PLAIN, *rows)))
    return _staged(problem, starts[:FOLLOWED], rows)


def _staged(problem: GantryPaths, starts: Sequence[Mapping[str, float]], rows: tuple[str, ...]) -> Staged:
    """The best of the plain fits from `starts`, and from there the fit of everything."""
    plain = [fit(problem, start, (*PLAIN, *rows), problem.everything, ROUNDS) for start in starts]
    best = min(plain, key=lambda one: one.loss)
    if "command_delay" in rows:
        best = _delay_in_steps(problem, best)
    return Staged(best, fit(problem, best.values, (*problem.base, *rows), problem.everything, ROUNDS))


def _delay_in_steps(problem: GantryPaths, law: Fit) -> Fit:
    """The fit with a delay looked for about the one found: where motors heed a plan at ticks, it acts in steps."""
    tick = max(run.orders.tick for run in problem.runs)
    free = tuple(row for row in law.free if row != "command_delay")
    late = [max(law.values["command_delay"] + share * tick, 0.0) for share in STEPS]
    starts = [{**law.values, "command_delay": delay} for delay in late]
    if not tick:
        return law
    best = min(starts, key=lambda start: promise(problem, start, free))
    return fit(problem, fit(problem, best, free, problem.everything, ROUNDS).values, law.free, problem.everything, ONCE)


def _std(law: Fit, row: str) -> float:
    k = law.free.index(row)
    return float(np.sqrt(law.covariance[k, k]))


def _mean_square(problem: GantryPaths, law: Fit) -> float:
    """Mean square residual of what may be seen, in units of the noise."""
    left = problem.residuals(law.values, (), problem.everything).r
    return float(left @ left) / float(problem.freedom.sum())


def _all(problem: GantryPaths, law: Fit) -> np.ndarray:
    return problem.residuals(law.values, (), np.arange(problem.clusters)).r


def promise(problem: GantryPaths, start: Mapping[str, float], free: Sequence[str]) -> float:
    """What a law would leave if it were as its derivatives at `start` say."""
    found = problem.residuals(start, free, problem.everything)
    sums = gram.make_grams(free, found.r, found.jacobian, found.cluster, problem.clusters)
    columns = np.arange(len(free))
    theta = gram.solve(sums, columns, problem.everything)
    return float(gram.losses(sums, columns, theta, problem.everything).sum())
