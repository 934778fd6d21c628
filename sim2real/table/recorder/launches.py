"""The puck's launches: the one that helps most is asked for, and those that the camera sees are counted."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sim2real.table.backend import Backend, Place
from sim2real.table.mallet_driver import MalletDriver
from sim2real.table.recorder.launch_coverage import Launch, LaunchCoverage
from sim2real.table.recorder.launch_watcher import LaunchWatcher

LONGEST = 4.0  # s of a launch, after which the next one is asked for: slower motion is covered by slow launches
HOLD = 0.1  # s between plans that hold the mallet
HOLDING_VOLTS = 5.0  # V
GAP = 0.05  # m from walls and mallets at which a launch starts
TRIES = 100  # draws of a launch that does not start at a mallet


def record_launches(
    table: Backend,
    p: np.void,
    seconds: float,
    seed: int,
    report: Callable[[str], None],
    progress: Callable[[int, int], None],
) -> LaunchCoverage:
    """Have the puck launched again and again for `seconds` at a connected table, while its mallet is held where it is.

    report: takes the advice for each launch, a line; progress: called with the milliseconds done and all of them.
    Returns what was seen. TableFaultError, in one line, as of the backend.
    """
    random = np.random.default_rng(seed)
    coverage = LaunchCoverage(float(p["length"]), float(p["width"]))
    watcher = LaunchWatcher(coverage, float(p["puck_radius"]))
    begin, place = table.now(), table.place()
    driver = MalletDriver(p)
    driver.stand(*place, begin)
    while table.now() < begin + seconds:
        launch = coverage.next(random)
        report(f"{table.now() - begin:6.1f} s  launch {len(coverage.launches) + 1}: {launch.words}")
        table.place_puck(_puck(coverage, launch, p, place, random))
        watcher.begin(table.now())
        known, seen, end = len(coverage.launches), False, table.now() + table.patience
        while table.now() < min(end, begin + seconds):
            table.send(driver.plan([*place, HOLDING_VOLTS, HOLDING_VOLTS], table.now() + table.ahead))
            table.wait(table.now() + HOLD)
            reading = table.read()
            if reading.missed:
                driver.revert()
            for frame in reading.frames:
                watcher.take(frame)
            progress(round(1e3 * min(table.now() - begin, seconds)), round(1e3 * seconds))
            if len(coverage.launches) > known and not watcher.moving:
                break
            if len(coverage.launches) > known and not seen:
                seen, end = True, table.now() + LONGEST
    return coverage


def _puck(
    coverage: LaunchCoverage, launch: Launch, p: np.void, mallet: Place, random: np.random.Generator
) -> np.ndarray:
    """The puck (x, y, vx, vy) [m, m/s] of a launch, clear of the robot's `mallet` [m] and of one opposite to it."""
    size = np.array([coverage.length, coverage.width])
    mallets = np.array([mallet, size - mallet])
    clear = GAP + float(p["puck_radius"]) + float(p["mallet_radius"])
    puck = coverage.motion(launch, GAP, random)
    for _ in range(TRIES):
        if np.hypot(*(puck[:2] - mallets).T).min() > clear:
            break
        puck = coverage.motion(launch, GAP, random)
    return puck
