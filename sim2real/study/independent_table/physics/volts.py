"""Plans as voltages in time: Eq. (4)-(5) as one list of times at which a voltage changes.

The effects between plan and motors are also applied here, once per plan: supply sag, deadband, and delay.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np

from sim2real.study.independent_table.physics.law import Law

Plan: TypeAlias = tuple[float, float, float, float, float, float]  # Vx, Vy, tx1, ty1, tx2, ty2
Plans: TypeAlias = "Plan | Sequence[tuple[float, Plan | None]] | None"  # one, none, or (start, plan) in order


def schedule(law: Law, plans: Sequence[Plans]) -> tuple[np.ndarray, np.ndarray]:
    """Times (m,), of which the first is 0, and the volts at the motors (m, k, 2) from each of them on."""
    changes = [sorted_changes(law, each) for each in plans]
    times = sorted({0.0} | {time for one in changes for time, _ in one})
    volts = np.zeros((len(times), len(plans), 2))
    for k, one in enumerate(changes):
        for row, time in enumerate(times):
            past = [pair for start, pair in one if start <= time]
            volts[row, k] = past[-1] if past else (0.0, 0.0)
    return np.array(times), volts


def sorted_changes(law: Law, plans: Plans) -> list[tuple[float, tuple[float, float]]]:
    """The times at which one mallet's pair of volts changes; a new plan replaces the one before it."""
    if plans is None:
        return []
    if len(plans) == 6 and not isinstance(plans[0], Sequence):
        plans = [(0.0, plans)]  # type: ignore[list-item] - one plan alone is taken too
    starts = [(start + law.command_delay, plan) for start, plan in plans]  # type: ignore[misc] - one plan alone is taken too
    changes = []
    for start, plan in starts:
        if plan is None:
            changes.append((start, (0.0, 0.0)))
            continue
        volts_x, volts_y = at_the_motors(law, plan[0], plan[1])
        tx1, ty1, tx2, ty2 = plan[2:]
        for moment in sorted({0.0, tx1, ty1, tx2, ty2}):
            if moment >= 0.0:
                pair = (profile(volts_x, tx1, tx2, moment), profile(volts_y, ty1, ty2, moment))
                changes.append((start + moment, pair))
    return changes


def profile(volts: float, t1: float, t2: float, t: float) -> float:
    """Eq. (4): +V before t1, -V before t2, 0 after."""
    return volts if t < t1 else -volts if t < t2 else 0.0


def at_the_motors(law: Law, volts_x: float, volts_y: float) -> tuple[float, float]:
    """A plan's signed volts minus the deadband, divided by 1 + sag (|Vx| + |Vy|) with the plan's two volts."""
    sag = 1.0 + law.voltage_sag * (abs(volts_x) + abs(volts_y))
    kept_x, kept_y = (max(0.0, abs(volts) - law.deadband) / sag for volts in (volts_x, volts_y))
    return (kept_x if volts_x > 0.0 else -kept_x), (kept_y if volts_y > 0.0 else -kept_y)
