"""Identify the period of the motors' control loop: whether a plan takes effect immediately or at the next tick.

A switch that takes effect up to one tick late is not missing physics but looks like it. The period is therefore
estimated first, with all laws of the volts free, so that none of them absorbs it.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sim2real.diagnose.engine.least_squares import fit
from sim2real.diagnose.regimes.gantry.listed_effects import linearised_loss
from sim2real.diagnose.regimes.gantry.residuals import LOW_ORDER, GantryResiduals
from sim2real.diagnose.regimes.gantry.tuned import CONTROL_TICK

# Laws that are free while the period is searched: those of the volts, then belt or backlash, each from a few starts
STARTS = (
    ({"voltage_sag": 0.0, "motor_deadband": 0.0, "command_delay": 0.0, "encoder_clock": 0.0},),
    tuple({"belt_hz": hz, "belt_zeta": 0.15} for hz in (7.0, 12.0, 20.0, 35.0)),
    ({"backlash_gap": 5e-4}, {"backlash_gap": 2e-3}),
)


def find_tick(problem: GantryResiduals) -> float:
    """The control loop's period [s] that best explains the first run with switches; 0 if plans act immediately."""
    run = next((one for one in problem.runs if one.drive_inputs.switch.any()), None)
    if run is None:
        return 0.0
    part = problem.of([run.first_windows(CONTROL_TICK.windows).thinned(CONTROL_TICK.samples)])
    for starts in STARTS:
        law, excess = min((_fitted(part, start, tuple(start)) for start in starts), key=lambda one: one[1])
        if excess < CONTROL_TICK.least_excess:
            return 0.0
        tick, rest = _best_tick(part, law, tuple(row for row in starts[0] if row != "command_delay"))
        if excess - rest > max(CONTROL_TICK.least_excess, CONTROL_TICK.least_share * excess):
            return tick
    return 0.0


def _best_tick(part: GantryResiduals, law: Mapping[str, float], rows: tuple[str, ...]) -> tuple[float, float]:
    """The period [s] that best explains the windows with the parameters `rows` free, and its excess (see `_fitted`).

    The delay is searched on a grid because its effect is discontinuous with ticks.
    """
    parts = {tick: part.of([part.runs[0].with_tick(tick)]) for tick in CONTROL_TICK.periods}
    found = law.get("command_delay", 0.0)
    tries = [
        (tick, delay)
        for tick in CONTROL_TICK.periods
        for delay in {0.0, *(max(found + share * tick, 0.0) for share in CONTROL_TICK.delay_steps)}
    ]
    free = (*LOW_ORDER, *rows)
    tries.sort(key=lambda one: linearised_loss(parts[one[0]], {**law, "command_delay": one[1]}, free))
    fits = [
        (_fitted(parts[tick], {**law, "command_delay": delay}, rows)[1], tick)
        for tick, delay in tries[: CONTROL_TICK.followed]
    ]
    excess, tick = min(fits)
    return tick, excess


def _fitted(
    problem: GantryResiduals, start: Mapping[str, float], rows: tuple[str, ...]
) -> tuple[Mapping[str, float], float]:
    """Fit `rows` and LOW_ORDER from `start`; return the parameters and the mean log of the windows' mean squares."""
    everywhere = np.arange(problem.clusters)
    law = fit(problem, start, (*LOW_ORDER, *rows), everywhere, CONTROL_TICK.rounds)
    last = problem.residuals(law.values, (), everywhere)
    return law.values, float(np.mean(np.log(np.bincount(last.cluster, last.r**2) / problem.freedom)))
