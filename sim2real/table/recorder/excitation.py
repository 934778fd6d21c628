"""The gantry's excitation: moves of each axis alone and of both together, at several voltages, far and near."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from puckpilot_env.game import mirror
from sim2real.table.backend import Backend, Place
from sim2real.table.mallet_driver import MalletDriver, planned_volts

VOLTS = (4.0, 7.0, 10.0, 14.0)  # V, from where friction matters to what a motor may get
AXES = ((True, False), (False, True), (True, True))  # which axes a move drives
MARGIN = 0.02  # m inside its area: a gantry that is not yet identified overshoots
SHORTEST = 0.08  # m of a move along each axis that it drives
RESTS = (0.1, 0.3)  # s between the end of a move and the next one, from and to
SLICE = 0.1  # s between readings


@dataclass(frozen=True)
class Move:
    """A move to `place` [m] at `volts` of axes x and y [V], and how long the mallet rests there [s]."""

    place: Place
    volts: tuple[float, float]
    rest: float


def refuse_volts(p: np.void, volts: Sequence[float]) -> None:
    """ValueError, in one line, for a voltage that a plan may not give a motor."""
    most = planned_volts(p)
    for one in volts:
        if not 0.0 < one <= most:
            raise ValueError(f"a voltage of the excitation is {one:g} V; expected more than 0, at most {most:g} V")


def excitation(p: np.void, start: Place, volts: Sequence[float], seed: int) -> Iterator[Move]:
    """Moves without end from `start` [m], in rounds: each has every voltage of `volts` with every choice of axes once,
    in random order. With both axes, the second axis has a voltage of its own."""
    random = np.random.default_rng(seed)
    x_low, x_high, y_low, y_high = mirror.area(0, p)
    low, high = np.array([x_low, y_low]) + MARGIN, np.array([x_high, y_high]) - MARGIN
    kinds = [(one, axes) for one in volts for axes in AXES]
    place = np.array(start, float)
    while True:
        for k in random.permutation(len(kinds)):
            one, axes = kinds[k]
            for axis in np.flatnonzero(axes):
                place[axis] = _far_enough(random, place[axis], low[axis], high[axis])
            other = float(random.choice(volts)) if all(axes) else one
            both = (one, other) if random.random() < 0.5 else (other, one)
            yield Move((float(place[0]), float(place[1])), both, float(random.uniform(*RESTS)))


def _far_enough(random: np.random.Generator, here: float, low: float, high: float) -> float:
    """A place from `low` to `high` [m], at least SHORTEST from `here`."""
    while True:
        place = float(random.uniform(low, high))
        if abs(place - here) >= SHORTEST:
            return place


def excite_gantry(
    table: Backend,
    p: np.void,
    seconds: float,
    volts: Sequence[float],
    seed: int,
    progress: Callable[[int, int], None],
) -> int:
    """Drive a connected table's mallet through `excitation` for `seconds`; return the number of moves.

    progress: called with the milliseconds done and all of them. TableFaultError, in one line, as of the backend.
    """
    driver, begin, count = MalletDriver(p), table.now(), 0
    driver.stand(*table.place(), begin)
    for move in excitation(p, table.place(), volts, seed):
        if table.now() >= begin + seconds:
            break
        table.send(driver.plan([*move.place, *move.volts], table.now() + table.ahead))
        count += 1
        while not driver.standing(table.now()):
            _pass(table, driver, SLICE)
        _pass(table, driver, move.rest)
        progress(round(1e3 * min(table.now() - begin, seconds)), round(1e3 * seconds))
    return count


def _pass(table: Backend, driver: MalletDriver, seconds: float) -> None:
    table.wait(table.now() + seconds)
    if table.read().missed:
        driver.revert()
