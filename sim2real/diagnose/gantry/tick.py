"""The motors' control loop: does it heed a plan at once, or at the next tick of which period?

A switch that comes up to a tick late is no physics, but it looks like some: it is found first, with every law of the
volts free at once so that none of them is mistaken for it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sim2real.diagnose.engine.fit import fit

if TYPE_CHECKING:
    from sim2real.diagnose.gantry.problem import GantryProblem

TICKS = (1e-4, 2e-4, 2.5e-4, 5e-4, 1e-3, 2e-3, 2.5e-3, 4e-3, 5e-3, 1e-2)  # s
FREE = ("voltage_sag", "motor_deadband", "command_delay")
ENOUGH, SAMPLES = 16, 2000  # windows, and samples in them
GAIN = 0.5  # of the typical log of a window's mean square, for a tick to be believed


def find_tick(problem: GantryProblem) -> float:
    """The period [s] of the control loop that explains the switches of the first run best; 0: heeded at once."""
    part = problem.runs[0].first_windows(ENOUGH).thinned(SAMPLES)
    found = {tick: _misfit(problem.of([part.with_tick(tick)])) for tick in (0.0, *TICKS)}
    best = min(found, key=lambda tick: found[tick])
    return best if found[best] < found[0.0] - GAIN else 0.0


def _misfit(problem: GantryProblem) -> float:
    """The mean log of the windows' mean squares, after a fit of everything that the volts may lack."""
    everywhere = np.arange(problem.clusters)
    law = fit(problem, {}, (*problem.base, *FREE), everywhere)
    last = problem.residuals(law.values, (), everywhere)
    return float(np.mean(np.log(np.bincount(last.cluster, last.r**2) / problem.freedom)))
