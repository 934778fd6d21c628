"""The motors' control loop: does it heed a plan at once, or at the next tick of which period?

A switch that comes up to a tick late is no physics, but it looks like some: it is found first, with every law of the
volts free at once so that none of them is mistaken for it.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sim2real.diagnose.engine.fit import fit
from sim2real.diagnose.gantry.candidates import promise
from sim2real.diagnose.gantry.paths import PLAIN, GantryPaths

TICKS = (1e-4, 2e-4, 2.5e-4, 5e-4, 1e-3, 2e-3, 2.5e-3, 4e-3, 5e-3, 1e-2)  # s
WORLDS = (  # what the volts may lack, and then what may give between motor and mallet, each from a few starts
    ({"voltage_sag": 0.0, "motor_deadband": 0.0, "command_delay": 0.0, "encoder_clock": 0.0},),
    tuple({"belt_hz": hz, "belt_zeta": 0.15} for hz in (7.0, 12.0, 20.0, 35.0)),
    ({"backlash_gap": 5e-4}, {"backlash_gap": 2e-3}),
)
ENOUGH, SAMPLES = 16, 2000  # windows, and samples in them
EXPLAINED = 0.05  # log of a window's mean square in units of the noise, below which nothing is lacking
FOLLOWED, ROUNDS = 2, 15  # ticks that look best by the derivatives are fitted
LATE = (-1.0, -0.75, -0.5, -0.25, 0.0)  # ticks, by which a delay may be less than it looks without them
SHARE = 0.3  # of that log, which a tick must explain to be believed


def find_tick(problem: GantryPaths) -> float:
    """The period [s] of the control loop that explains best the switches of the first run that has any;
    0: heeded at once."""
    run = next((one for one in problem.runs if one.orders.switch.any()), None)
    if run is None:
        return 0.0
    part = problem.of([run.first_windows(ENOUGH).thinned(SAMPLES)])
    for starts in WORLDS:
        law, left = min((_fitted(part, start, tuple(start)) for start in starts), key=lambda one: one[1])
        if left < EXPLAINED:
            return 0.0
        tick, found = _best_tick(part, law, tuple(row for row in starts[0] if row != "command_delay"))
        if left - found > max(EXPLAINED, SHARE * left):
            return tick
    return 0.0


def _best_tick(part: GantryPaths, law: Mapping[str, float], rows: tuple[str, ...]) -> tuple[float, float]:
    """The tick that explains the windows best with the parameters `rows` free, and what it leaves, as `_fitted` says.

    A delay is no free parameter here: with ticks it acts in steps.
    """
    parts = {tick: part.of([part.runs[0].with_tick(tick)]) for tick in TICKS}
    late = law.get("command_delay", 0.0)
    tries = [(tick, delay) for tick in TICKS for delay in {0.0, *(max(late + share * tick, 0.0) for share in LATE)}]
    free = (*PLAIN, *rows)
    tries.sort(key=lambda one: promise(parts[one[0]], {**law, "command_delay": one[1]}, free))
    fits = [(_fitted(parts[tick], {**law, "command_delay": delay}, rows)[1], tick) for tick, delay in tries[:FOLLOWED]]
    left, tick = min(fits)
    return tick, left


def _fitted(
    problem: GantryPaths, start: Mapping[str, float], rows: tuple[str, ...]
) -> tuple[Mapping[str, float], float]:
    """The law fitted from `start`, `rows` and the plain baseline free; and the mean log of windows' mean squares."""
    everywhere = np.arange(problem.clusters)
    law = fit(problem, start, (*PLAIN, *rows), everywhere, ROUNDS)
    last = problem.residuals(law.values, (), everywhere)
    return law.values, float(np.mean(np.log(np.bincount(last.cluster, last.r**2) / problem.freedom)))
