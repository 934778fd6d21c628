"""The true motion inside a step: what a table is like at any moments of it, without touching the table."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puckpilot_env.game import state
from puckpilot_env.game.motion import play_step
from puckpilot_env.game.sensing import EXACT, MOST_WANTED, SHOT_COLUMNS
from puckpilot_env.game.step import plan_both, play_and_film
from puckpilot_env.kernel import announce_compilation, array_kernel
from puckpilot_env.physics.advance import EVENT_COLUMNS
from puckpilot_env.tables import Tables


@array_kernel
def trace_step(moments, p, nominal, rules, frames, actions, times, scored):
    """Play copies of a table from where it is to different moments of its step.

    moments: (m,) `state.TABLE` records, all equal to the table; each is left as it is at its own time. p, nominal,
    rules: (1,) records; frames: its (kept,) camera frames, scratch; actions: float32 (2, 4); times: (m,) [s], from 0
    to the period of a step; scored: (m,) bool, written: the puck is in a goal.

    Each copy is played from the start in one stretch, because a stretch cut in two differs in its last digits.
    """
    film = np.zeros((MOST_WANTED, SHOT_COLUMNS))
    log = np.zeros((0, EVENT_COLUMNS))
    rewards = np.zeros(2, np.float32)
    rule = rules[0]
    for i in range(times.size):
        table = moments[i]
        plan_both(table, p[0], nominal[0], actions, rewards)
        if times[i] >= rule.period and rule.sensing != EXACT:
            scored[i] = play_and_film(table, p[0], rule, frames, rewards, log, film)
        else:
            scored[i] = play_step(table, p[0], rule, times[i], rewards, log, film[:0])
        table.time += times[i]


def trace(
    tables: Tables, table: int, actions: ArrayLike, times: Sequence[float] | NDArray[np.floating]
) -> tuple[NDArray[Any], NDArray[np.bool_]]:
    """What `tables.step(actions)` will take table number `table` through; nothing of `tables` changes.

    actions: (2, 4), of this table; times: (m,) seconds after the step's begin, at most its period. Returns (m,) records
    of `state.TABLE`, and (m,) whether the puck is in a goal by then. At the period, puck and mallets are where they are
    after the step, unless the step ends in a new start of a point or an episode.
    """
    times = np.asarray(times, np.float64)
    actions = np.ascontiguousarray(actions, np.float32)
    if actions.shape != (2, 4):
        raise ValueError(f"actions have shape {actions.shape}; expected (2, 4)")
    if times.ndim != 1 or not np.all((times >= 0.0) & (times <= tables.variant.period)):
        raise ValueError(f"times are {times}; expected a row of numbers from 0 to {tables.variant.period:g} s")
    announce_compilation("trace_step")
    now = tables.snapshot([table])
    moments = np.zeros(len(times), state.TABLE)
    moments[:] = now.states[0]
    scored = np.zeros(len(times), np.bool_)
    trace_step(moments, now.params, tables.nominal, tables.variant.rules(), now.frames[0], actions, times, scored)
    return moments, scored
