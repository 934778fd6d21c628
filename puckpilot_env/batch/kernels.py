"""The kernels behind `tables.Tables`: a range of tables through a step, a reset, a check."""

from __future__ import annotations

import numpy as np

from puckpilot_env.batch.team import hand_in, take
from puckpilot_env.game import random_stream
from puckpilot_env.game.rules import RUNNING, STEP_LIMIT
from puckpilot_env.game.sensing import MOST_WANTED, SHOT_COLUMNS
from puckpilot_env.game.step import begin_table, observe_table, step_table
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.advance import EVENT_COLUMNS

LEAST_RANGE = 16  # tables that a thread takes at once: fewer, and two threads write next to each other too often


def ranges(tables: int, threads: int) -> np.ndarray:
    """Int64 `(m, 2)`, from first to last table of ranges for threads to take in turn: ever smaller ones, so that all
    threads end at about the same time."""
    ranges, first = [], 0
    while first < tables:
        last = min(first + max((tables - first) // (2 * threads), LEAST_RANGE), tables)
        ranges.append((first, last))
        first = last
    return np.array(ranges)


@kernel
def first_outside(actions, bounds):
    """Flat index of the first action number that is NaN or outside `bounds` (2, 4), or -1."""
    for i in range(actions.shape[0]):
        outside = False  # looked for without a way out, a table's numbers are compared side by side
        for k in range(2):
            for c in range(4):
                outside |= not (bounds[0, c] <= actions[i, k, c] <= bounds[1, c])
        if outside:
            for k in range(2):
                for c in range(4):
                    if not (bounds[0, c] <= actions[i, k, c] <= bounds[1, c]):
                        return 8 * i + 4 * k + c
    return -1


@kernel
def seed_range(states, seed):
    """Start every table's random streams from `seed` and its index."""
    for i in range(states.size):
        table, index = states[i], np.uint64(i)
        random_stream.seed_stream(table.streams[0], seed, index, 0)
        random_stream.seed_stream(table.streams[1], seed, index, 1)
        random_stream.seed_stream(table.stream, seed, index, 2)


@kernel
def reset_range(states, params, nominal, rows, drawn, rules, frames, bounds, observations):
    """Begin a new episode on every table."""
    for i in range(states.size):
        begin_table(states[i], params[i], rows[i], drawn, rules[0], frames[i])
        observe_table(states[i], params[i], nominal[0], rules[0], frames[i], bounds, observations[i])


@kernel
def _copy_rows(source, target):
    for k in range(source.shape[0]):
        for c in range(source.shape[1]):
            target[k, c] = source[k, c]


def scratch(threads: int) -> tuple[np.ndarray, np.ndarray]:
    """`log, films` of so many threads: no events are logged, and every frame of a step has its place."""
    return np.zeros((0, EVENT_COLUMNS)), np.zeros((threads, MOST_WANTED, SHOT_COLUMNS))


@kernel
def step_range(
    states, params, nominal, rows, drawn, rules, frames, bounds, actions, observations, finals, rewards, terminated,
    truncated, autoreset, log, film, first, last,
):  # fmt: skip
    """Play one step on tables `first` to `last`, and begin a new episode where one ended, if `autoreset`.

    log, film: scratch, see `game.step.step_table`.
    """
    rule = rules[0]
    for i in range(first, last):
        table, p = states[i], params[i]
        step_table(table, p, nominal[0], rule, frames[i], actions[i], rewards[i], log, film)
        ended = table.ending != RUNNING
        truncated[i] = table.ending == STEP_LIMIT
        terminated[i] = ended and not truncated[i]
        observe_table(table, p, nominal[0], rule, frames[i], bounds, observations[i])
        if ended and autoreset:
            _copy_rows(observations[i], finals[i])
            begin_table(table, p, rows[i], drawn, rule, frames[i])
            observe_table(table, p, nominal[0], rule, frames[i], bounds, observations[i])


@kernel
def step_ranges(
    states, params, nominal, rows, drawn, rules, frames, bounds, actions, observations, finals, rewards, terminated,
    truncated, autoreset, log, films, ranges, counters, member, patience,
):  # fmt: skip
    """`step_range` for what one thread of a team takes of the `ranges`; see `team.Team`."""
    while True:
        part = take(counters, ranges.shape[0], patience)
        if part < 0:
            break
        step_range(
            states, params, nominal, rows, drawn, rules, frames, bounds, actions, observations, finals, rewards,
            terminated, truncated, autoreset, log, films[member], ranges[part, 0], ranges[part, 1],
        )  # fmt: skip
        hand_in(counters)
