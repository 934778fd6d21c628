"""The small-step loop: advance all bodies; if a step ends in an overlap, go back to the time of contact."""

from __future__ import annotations

from math import sqrt

import numpy as np

from puckpilot_env.kernel import array_kernel, kernel
from sim2real.study.independent_table.physics.bounce import RESTING, approach, bounce
from sim2real.study.independent_table.physics.gantry import advance_mallets
from sim2real.study.independent_table.physics.puck import VX, VY, X, Y, advance_puck
from sim2real.study.independent_table.physics.table import GOAL, MALLET, POST, gap, normal

HALVINGS = 60  # halvings of a step to find the time of a contact
MOST_CONTACTS = 20  # in one step; with more, the puck counts as jammed until nothing pushes it
TOUCHING = 1e-12  # m, largest gap that counts as contact
OVERLAP = 1e-9  # m, larger overlaps are separated (a pinched puck, a lasting contact)
# Columns of the contact log: time, obstacle, then the state before: x, y, speed, closing speed, nx, ny
LOG_COLUMNS = 8


@array_kernel
def march(law, puck, mallets, times, volts, clock, duration, dt, sample, out_puck, out_mallets, log):
    """Fill `out_puck` (n, 6), `out_mallets` (n, k, 6 or 12) every `sample` seconds, and `log` (rows, 8).

    `clock` is the time at the start, for laws that change with time. `puck` (6,) and `mallets` (k, 6 or 12) are the
    start and are overwritten with the end. Returns the number of contacts, which may exceed the rows of the log, and
    the nearest miss [m]: the smallest gap at which the puck passed a post or a mallet without contact.
    """
    obstacles = MALLET + mallets.shape[0]
    now = np.empty(obstacles)  # gaps at the start of the step
    falling, held = np.zeros(obstacles, np.bool_), np.zeros(obstacles, np.bool_)
    touched = np.zeros(obstacles, np.bool_)
    next_puck, next_mallets = puck.copy(), mallets.copy()
    alive = not np.isnan(puck[X])
    if alive:
        for which in range(obstacles):
            now[which] = gap(law, which, puck, mallets)
    nearest_miss, contacts, row, change, jammed = np.inf, 0, 0, 0, False
    t = 0.0
    while True:
        if row < out_puck.shape[0] and t >= min(row * sample, duration):
            copy(puck, out_puck[row])
            copy_rows(mallets, out_mallets[row])
            row += 1
        if t >= duration:
            return contacts, nearest_miss
        while change + 1 < times.shape[0] and times[change + 1] <= t:
            change += 1
        end = step_end(t, dt, duration, row * sample, times, change)
        for which in range(obstacles):
            held[which] = touched[which] = False
        for tries in range(MOST_CONTACTS + 1):
            h = end - t
            advance_mallets(law, mallets, volts[change], h, next_mallets)
            if not alive:
                break
            advance_puck(law, clock + t, puck, h, next_puck)
            jammed = jammed or tries == MOST_CONTACTS
            if jammed:
                break
            which, h = first_contact(law, clock + t, h, puck, mallets, volts[change], held, next_puck, next_mallets)
            if which < 0:
                break
            copy(next_puck, puck)
            copy_rows(next_mallets, mallets)
            t += h
            touched[which] = True
            nx, ny = normal(law, which, puck, mallets)
            closing = approach(which, puck, mallets, nx, ny)
            scored = which >= GOAL and which < MALLET
            if closing > RESTING or scored:
                if contacts < log.shape[0]:
                    write_log(log[contacts], t, which, puck, closing, nx, ny)
                contacts += 1
            else:
                held[which] = True
            if scored:
                alive = False
                for i in range(puck.shape[0]):
                    puck[i] = next_puck[i] = np.nan
            else:
                bounce(law, clock + t, which, puck, mallets, nx, ny)
        t = end
        copy(next_puck, puck)
        copy_rows(next_mallets, mallets)
        if not alive:
            continue
        jammed = separate_all(law, puck, mallets, held) and jammed
        for which in range(POST, obstacles):
            if which >= GOAL and which < MALLET:
                continue
            after = gap(law, which, puck, mallets)
            if after > now[which] and falling[which] and not touched[which]:
                nearest_miss = min(nearest_miss, max(0.0, now[which]))
            falling[which] = after < now[which] and not touched[which]
            now[which] = after


@kernel
def step_end(t, dt, duration, next_sample, times, change):
    """The end of the step: at most dt, the next sample, or the next change of a voltage."""
    limit = min(duration, next_sample) if next_sample > t else duration
    if change + 1 < times.shape[0]:
        limit = min(limit, times[change + 1])
    return limit if t + 1.000001 * dt >= limit else t + dt


@kernel
def first_contact(law, t, h, puck, mallets, volts, held, next_puck, next_mallets):
    """The first obstacle in contact within h, and the time (or -1, h); sets the `next_*` states to that time."""
    first, moment = -1, h
    for which in range(MALLET + mallets.shape[0]):
        if held[which]:
            continue
        end_gap = gap(law, which, next_puck, next_mallets)
        if end_gap >= 0.0:
            continue
        start_gap = gap(law, which, puck, mallets)
        if end_gap >= start_gap:
            continue
        low, high = (
            0.0,
            moment if start_gap > TOUCHING else 0.0,
        )  # `next_*` is at `moment`, so a later obstacle counts only if its contact is earlier
        for _ in range(HALVINGS if high > 0.0 else 0):
            middle = 0.5 * (low + high)
            advance_puck(law, t, puck, middle, next_puck)
            advance_mallets(law, mallets, volts, middle, next_mallets)
            if gap(law, which, next_puck, next_mallets) < 0.0:
                high = middle
            else:
                low = middle
        first, moment = which, low
        advance_puck(law, t, puck, moment, next_puck)
        advance_mallets(law, mallets, volts, moment, next_mallets)
    return first, moment


@kernel
def separate_all(law, puck, mallets, held):
    """End a step: stop the closing motion of lasting contacts, and separate overlaps; walls are last.

    A puck pinched between a mallet and a wall may still overlap the mallet, so that it cannot leave the table. Returns
    whether any obstacle pushed the puck.
    """
    pushed = False
    for k in range(mallets.shape[0] - 1, -1, -1):
        pushed |= separate(law, MALLET + k, puck, mallets, held)
    for which in range(POST, GOAL):
        pushed |= separate(law, which, puck, mallets, held)
    for which in range(POST):
        pushed |= separate(law, which, puck, mallets, held)
    return pushed


@kernel
def separate(law, which, puck, mallets, held):
    """`separate_all` for one obstacle."""
    distance = gap(law, which, puck, mallets)
    if not held[which] and distance >= -OVERLAP:
        return False
    nx, ny = normal(law, which, puck, mallets)
    if distance < 0.0:
        puck[X] -= distance * nx
        puck[Y] -= distance * ny
    closing = approach(which, puck, mallets, nx, ny)
    if closing > 0.0:
        puck[VX] += closing * nx
        puck[VY] += closing * ny
    return True


@kernel
def copy(source, target):
    """Do `target[:] = source`, which numba compiles far more slowly."""
    for i in range(source.shape[0]):
        target[i] = source[i]


@kernel
def copy_rows(source, target):
    """`copy` for the states of mallets."""
    for k in range(source.shape[0]):
        copy(source[k], target[k])


@kernel
def write_log(row, t, which, puck, closing, nx, ny):
    """Write one contact to a row of the log."""
    row[0], row[1], row[2], row[3] = t, which, puck[X], puck[Y]
    row[4] = sqrt(puck[VX] ** 2 + puck[VY] ** 2)
    row[5], row[6], row[7] = closing, nx, ny
