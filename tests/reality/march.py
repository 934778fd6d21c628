"""The small-step loop: advance everything, and where the step ran into something, go back to the instant of contact."""

from __future__ import annotations

import numpy as np
from numba import njit

from tests.reality.bounce import RESTING, approach, bounce
from tests.reality.gantry import advance_mallets
from tests.reality.puck import VX, VY, X, Y, advance_puck
from tests.reality.table import GOAL, MALLET, POST, gap, normal

HALVINGS = 60  # of a step, to find the instant of a contact
MOST_CONTACTS = 50  # in one step; what is left of the step is then spent in contact
OVERLAP = 1e-9  # m, more than this is pushed apart (a pinched puck, a lasting contact)
# Columns of the contact log: time, obstacle, then the puck before: x, y, speed, closing speed, nx, ny.
LOG_COLUMNS = 8


@njit
def march(law, puck, mallets, times, volts, duration, dt, sample, out_puck, out_mallets, log):
    """Fill `out_puck` (n, 5), `out_mallets` (n, k, 6) every `sample` seconds, and `log` (rows, 8).

    `puck` (5,) and `mallets` (k, 6) are the start and become the end. Returns the number of contacts (more than
    the log has rows: the rest was not written) and the nearest miss [m]: the smallest gap at which the puck passed a
    post or a mallet without touching it.
    """
    obstacles = MALLET + mallets.shape[0]
    now = np.empty(obstacles)  # gaps at the start of the step
    falling, held = np.zeros(obstacles, np.bool_), np.zeros(obstacles, np.bool_)
    next_puck, next_mallets = puck.copy(), mallets.copy()
    alive = not np.isnan(puck[X])
    if alive:
        for which in range(obstacles):
            now[which] = gap(law, which, puck, mallets)
    nearest_miss, contacts, row, change = np.inf, 0, 0, 0
    t = 0.0
    while True:
        if row < out_puck.shape[0] and t >= min(row * sample, duration):
            out_puck[row] = puck
            out_mallets[row] = mallets
            row += 1
        if t >= duration:
            return contacts, nearest_miss
        while change + 1 < times.shape[0] and times[change + 1] <= t:
            change += 1
        end = step_end(t, dt, duration, row * sample, times, change)
        held[:] = False
        for tries in range(MOST_CONTACTS):
            h = end - t
            advance_mallets(law, mallets, volts[change], h, next_mallets)
            if not alive:
                break
            advance_puck(law, t, puck, h, next_puck)
            which, h = first_contact(law, t, h, puck, mallets, volts[change], held, next_puck, next_mallets)
            if which < 0 or tries == MOST_CONTACTS - 1:
                break
            puck[:] = next_puck
            mallets[:] = next_mallets
            t += h
            falling[which] = False
            nx, ny = normal(law, which, puck, mallets)
            closing = approach(which, puck, mallets, nx, ny)
            if closing > RESTING or which >= GOAL and which < MALLET:
                if contacts < log.shape[0]:
                    speed = np.hypot(puck[VX], puck[VY])
                    log[contacts] = (t, float(which), puck[X], puck[Y], speed, closing, nx, ny)
                contacts += 1
            else:
                held[which] = True
            if which >= GOAL and which < MALLET:
                alive = False
                puck[:] = np.nan
                next_puck[:] = np.nan
            else:
                bounce(law, which, puck, mallets, nx, ny)
        t = end
        puck[:] = next_puck
        mallets[:] = next_mallets
        if not alive:
            continue
        part(law, puck, mallets, held)
        for which in range(POST, obstacles):
            if which >= GOAL and which < MALLET:
                continue
            after = gap(law, which, puck, mallets)
            if after > now[which] and falling[which]:
                nearest_miss = min(nearest_miss, max(0.0, now[which]))
            falling[which] = after < now[which] and not held[which]
            now[which] = after


@njit
def step_end(t, dt, duration, next_sample, times, change):
    """End of the step: no further than dt, the next sample, or the next change of a voltage."""
    limit = min(duration, next_sample) if next_sample > t else duration
    if change + 1 < times.shape[0]:
        limit = min(limit, times[change + 1])
    return limit if t + 1.000001 * dt >= limit else t + dt


@njit
def first_contact(law, t, h, puck, mallets, volts, held, next_puck, next_mallets):
    """The obstacle first run into within h and when (or -1, h); the `next_*` states are left at that moment."""
    first, moment = -1, h
    for which in range(MALLET + mallets.shape[0]):
        if held[which]:
            continue
        end_gap = gap(law, which, next_puck, next_mallets)
        if end_gap >= 0.0 or end_gap >= gap(law, which, puck, mallets):
            continue
        low, high = 0.0, moment  # `next_*` stands at `moment`: so a later obstacle counts only if it is met before
        for _ in range(HALVINGS):
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


@njit
def part(law, puck, mallets, held):
    """End of a step: a lasting contact closes no further, and what overlaps is pushed apart. Walls have the last word.

    A puck pinched between a mallet and a wall may go on overlapping the mallet: it cannot leave the table.
    """
    for k in range(mallets.shape[0] - 1, -1, -1):
        keep_apart(law, MALLET + k, puck, mallets, held)
    for which in range(POST, GOAL):
        keep_apart(law, which, puck, mallets, held)
    for which in range(POST):
        keep_apart(law, which, puck, mallets, held)


@njit
def keep_apart(law, which, puck, mallets, held):
    distance = gap(law, which, puck, mallets)
    if not held[which] and distance >= -OVERLAP:
        return
    nx, ny = normal(law, which, puck, mallets)
    if distance < 0.0:
        puck[X] -= distance * nx
        puck[Y] -= distance * ny
    closing = approach(which, puck, mallets, nx, ny)
    if closing > 0.0:
        puck[VX] += closing * nx
        puck[VY] += closing * ny
