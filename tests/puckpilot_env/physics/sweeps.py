"""Loops over many scenes inside numba, and what each scene came to."""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.kernel import array_kernel
from puckpilot_env.physics.contacts import bounce
from tests.puckpilot_env.physics.scenes import UNITS, build
from tests.puckpilot_env.physics.table_driver import (
    AFTER_X,
    AFTER_Y,
    BEFORE_X,
    BEFORE_Y,
    KIND,
    SAMPLE_COLUMNS,
    areas,
    deepest,
    new_log,
    new_table,
    play,
)

# Columns of a verdict on a scene; NaN in all of them where the numbers made no scene
OUTSIDE, INTO_POST, INTO_MALLET, EVENTS, MALLET_EVENTS, GAIN, GRAZED, STALLED, MOVED_BY_CUTS, GOAL = range(10)
VERDICTS = 10
GRAZE = 1e-2  # of the puck's speed (and of 1 m/s); a mallet that changes its velocity by less has hardly touched it


@array_kernel
def judge_events(log, events, verdict):
    """Share of energy gained without a mallet, and whether any mallet only grazed the puck."""
    verdict[EVENTS] = events
    verdict[MALLET_EVENTS] = verdict[GRAZED] = 0.0
    verdict[GAIN] = -math.inf
    for i in range(events):
        row = log[i]
        before = row[BEFORE_X] ** 2 + row[BEFORE_Y] ** 2
        change = (row[AFTER_X] ** 2 + row[AFTER_Y] ** 2 - before) / (1.0 + before)
        if row[KIND] >= bounce.MALLET_0:
            verdict[MALLET_EVENTS] += 1
            if math.hypot(row[AFTER_X] - row[BEFORE_X], row[AFTER_Y] - row[BEFORE_Y]) < GRAZE * (
                1.0 + math.sqrt(before)
            ):
                verdict[GRAZED] = 1.0
        else:
            verdict[GAIN] = max(verdict[GAIN], change)


@array_kernel
def sweep(units, p, area, table, requests, duration, out, whole, log, verdicts):
    """Play each scene in `len(out) - 1` pieces and again in `len(whole) - 1`; `verdicts` (n, VERDICTS)."""
    puck, mallets = table.puck, table.mallets
    for i in range(units.shape[0]):
        verdict = verdicts[i]
        verdict[:] = math.nan
        if not build(units[i], p, area, table, requests):
            continue
        kind, rows, events = play(puck, p, mallets, 0.0, duration, out, log)
        verdict[OUTSIDE], verdict[INTO_POST], verdict[INTO_MALLET] = deepest(out, rows, p)
        judge_events(log, events, verdict)
        stalled = math.isfinite(mallets[0].x.halt) or math.isfinite(mallets[1].x.halt)
        x, y = puck.x, puck.y
        build(units[i], p, area, table, requests)
        kind_whole, _, _ = play(puck, p, mallets, 0.0, duration, whole, log)
        stalled = stalled or math.isfinite(mallets[0].x.halt) or math.isfinite(mallets[1].x.halt)
        verdict[STALLED] = 1.0 if stalled else 0.0
        verdict[MOVED_BY_CUTS] = math.hypot(puck.x - x, puck.y - y) if kind == kind_whole else math.inf
        verdict[GOAL] = kind


def judge(p: np.record, units: np.ndarray, duration: float, pieces: int) -> np.ndarray:
    """(n, VERDICTS) of scenes `units` (n, UNITS)."""
    verdicts = np.zeros((len(units), VERDICTS))
    out, whole = np.zeros((pieces + 1, SAMPLE_COLUMNS)), np.zeros((2, SAMPLE_COLUMNS))
    sweep(units, p, areas(p), new_table(p), np.zeros((2, 4)), duration, out, whole, new_log(), verdicts)
    return verdicts


def random_units(seed: int, scenes: int) -> np.ndarray:
    return np.random.default_rng(seed).random((scenes, UNITS))
