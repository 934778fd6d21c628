"""The motors' control loop: does it heed a plan at once, or at the next tick of which period?

A switch that comes up to a tick late is no physics, but it looks like some: it is found first, with every law of the
volts free at once so that none of them is mistaken for it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from sim2real.diagnose.engine.fit import fit
from sim2real.diagnose.gantry.candidates import promise

if TYPE_CHECKING:
    from sim2real.diagnose.gantry.problem import GantryProblem

TICKS = (1e-4, 2e-4, 2.5e-4, 5e-4, 1e-3, 2e-3, 2.5e-3, 4e-3, 5e-3, 1e-2)  # s
WORLDS = (  # what the volts may lack, and then what may give between motor and mallet, each from a few starts
    ({"voltage_sag": 0.0, "motor_deadband": 0.0, "command_delay": 0.0, "encoder_clock": 0.0},),
    tuple({"belt_hz": hz, "belt_zeta": 0.15} for hz in (7.0, 12.0, 20.0, 35.0)),
    ({"backlash_gap": 5e-4}, {"backlash_gap": 2e-3}),
)
ENOUGH, SAMPLES = 16, 2000  # windows, and samples in them
EXPLAINED = 0.05  # log of a window's mean square in units of the noise, below which nothing is lacking
FOLLOWED, ROUNDS = 2, 15  # ticks that look best by the derivatives are fitted
SHARE = 0.3  # of that log, which a tick must explain to be believed


def find_tick(problem: GantryProblem) -> float:
    """The period [s] of the control loop that explains the switches of the first run best; 0: heeded at once."""
    part = problem.of([problem.runs[0].first_windows(ENOUGH).thinned(SAMPLES)])
    for starts in WORLDS:
        law, left = min((_fitted(part, start) for start in starts), key=lambda one: one[1])
        if left < EXPLAINED:
            return 0.0
        parts = {tick: part.of([part.runs[0].with_tick(tick)]) for tick in TICKS}
        free = tuple(law)
        likely = sorted(TICKS, key=lambda tick: promise(parts[tick], law, free))[:FOLLOWED]
        found = {tick: _fitted(parts[tick], law)[1] for tick in likely}
        best = min(found, key=lambda tick: found[tick])
        if left - found[best] > max(EXPLAINED, SHARE * left):
            return best
    return 0.0


def _fitted(problem: GantryProblem, start: Mapping[str, float]) -> tuple[Mapping[str, float], float]:
    """The law fitted from `start`, its keys and the baseline's free, and the mean log of the windows' mean squares."""
    everywhere = np.arange(problem.clusters)
    law = fit(problem, start, tuple(dict.fromkeys((*problem.base, *start))), everywhere, ROUNDS)
    last = problem.residuals(law.values, (), everywhere)
    return law.values, float(np.mean(np.log(np.bincount(last.cluster, last.r**2) / problem.freedom)))
