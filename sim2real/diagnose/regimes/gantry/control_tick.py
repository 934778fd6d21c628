"""The motors' control loop: whether it obeys a plan at once, or at the next tick, and of which period.

A switch that comes up to a tick late is no missing physics, but looks like some: the period is found first, with every
law of the volts free at once so that none of them is mistaken for it.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sim2real.diagnose.engine.least_squares import fit
from sim2real.diagnose.regimes.gantry.listed_effects import linearised_loss
from sim2real.diagnose.regimes.gantry.residuals import LOW_ORDER, GantryResiduals
from sim2real.diagnose.regimes.gantry.tuned import CONTROL_TICK

# Laws beneath which a period is looked for: of the volts, then of belt or backlash, each from a few starts
STARTS = (
    ({"voltage_sag": 0.0, "motor_deadband": 0.0, "command_delay": 0.0, "encoder_clock": 0.0},),
    tuple({"belt_hz": hz, "belt_zeta": 0.15} for hz in (7.0, 12.0, 20.0, 35.0)),
    ({"backlash_gap": 5e-4}, {"backlash_gap": 2e-3}),
)


def find_tick(problem: GantryResiduals) -> float:
    """The period [s] of the control loop that best explains the first run with switches; 0: it obeys at once."""
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
    """The period [s] that best explains the windows with the parameters `rows` free, and its excess, as in `_fitted`.

    A delay is no free parameter here: with ticks it acts in steps.
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
    """The law fitted from `start`, `rows` and LOW_ORDER free; and its excess: the mean log of windows' mean squares."""
    everywhere = np.arange(problem.clusters)
    law = fit(problem, start, (*LOW_ORDER, *rows), everywhere, CONTROL_TICK.rounds)
    last = problem.residuals(law.values, (), everywhere)
    return law.values, float(np.mean(np.log(np.bincount(last.cluster, last.r**2) / problem.freedom)))
