"""Drives the product's kernels from inside numba, so that thousands of scenes run in seconds.

Everything here only starts, cuts and samples motions; what the samples must be like is said in the tests.
"""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.game.state import TABLE
from puckpilot_env.kernel import array_kernel
from puckpilot_env.parameters import make_records
from puckpilot_env.physics.advance import EVENT_COLUMNS, advance
from puckpilot_env.physics.contacts import bounce
from puckpilot_env.physics.gantry.mallet import place_at, set_constants, settle
from puckpilot_env.physics.gantry.plan import plan_mallet

# Columns of a sample: time, the puck, both mallets
T, PX, PY, PVX, PVY, M0X, M0Y, M1X, M1Y = range(9)
SAMPLE_COLUMNS = 9
# Columns of an event log that the tests read
TIME, KIND, EVENT_X, EVENT_Y, BEFORE_X, BEFORE_Y, AFTER_X, AFTER_Y = range(8)


def record(**values: float) -> np.record:
    """One parameter record for the kernels; `values` by name, unchecked, so that limits can be tried."""
    rows = make_records(1)
    for name, value in values.items():
        rows[name] = value
    return rows.view(np.recarray)[0]


def new_table(p: np.record) -> np.record:
    """A table whose mallets have the gantries of `p`."""
    table = np.zeros(1, TABLE).view(np.recarray)[0]
    give_gantries(table, p)
    return table


@array_kernel
def give_gantries(table, p):
    for k in range(2):
        mallet = table.mallets[k]
        set_constants(mallet.x, p.a1 - p.b1, p.a2 - p.b2, p.a3 - p.b3, p.pulley_radius)
        set_constants(mallet.y, p.a1 + p.b1, p.a2 + p.b2, p.a3 + p.b3, p.pulley_radius)


def areas(p: np.record) -> np.ndarray:
    """(2, 4): x_low, x_high, y_low, y_high [m] of either mallet's centre: its half, a mallet radius inside."""
    r, half = p.mallet_radius, 0.5 * p.length
    return np.array([(r, half - r, r, p.width - r), (half + r, p.length - r, r, p.width - r)])


def new_log(rows: int = 4000) -> np.ndarray:
    return np.zeros((rows, EVENT_COLUMNS))


@array_kernel
def put_at_rest(axis, position):
    axis.rest, axis.slow, axis.fast, axis.halt = position, 0.0, 0.0, math.inf


@array_kernel
def place(axis):
    """Position [m] of an axis when its plan begins."""
    return axis.rest + axis.slow + axis.fast


@array_kernel
def plan_both(mallets, requests, area, max_voltage):
    """`requests` (2, 4): x_f, y_f, vx, vy of either player; `area` (2, 4)."""
    for k in range(2):
        q = requests[k]
        plan_mallet(mallets[k], q[0], q[1], q[2], q[3], area[k], max_voltage)


@array_kernel
def cut(mallets, t):
    """Cut both plans at t."""
    for k in range(2):
        settle(mallets[k], t)


@array_kernel
def sample(row, t, puck, mallets):
    row[T] = t
    row[PX], row[PY], row[PVX], row[PVY] = puck.x, puck.y, puck.vx, puck.vy
    for k in range(2):
        row[M0X + 2 * k], row[M0Y + 2 * k] = place_at(mallets[k], t)


@array_kernel
def play(puck, p, mallets, start, end, out, log):
    """From `start` to `end` in `len(out) - 1` calls or more; `out` (n, SAMPLE_COLUMNS) takes the states between.

    Returns `(kind, rows, events)`: a goal's kind or NOTHING, the rows written, the events logged.
    """
    pieces = out.shape[0] - 1
    no_film = np.zeros((0, 3))
    sample(out[0], start, puck, mallets)
    events, now, kind = 0, start, bounce.NOTHING
    for i in range(1, pieces + 1):
        until = end if i == pieces else start + (end - start) * i / pieces
        while True:
            kind, now, count = advance(puck, p, mallets, 0.0, now, until, log[events:], no_film)
            events = min(events + count, log.shape[0])
            if kind != bounce.MIDDLE_LINE:
                break
        sample(out[i], now, puck, mallets)
        if kind != bounce.NOTHING:
            return kind, i + 1, events
    return kind, pieces + 1, events


@array_kernel
def deepest(out, rows, p):
    """Largest violations [m] in samples: `(out of the table, into a post, into a mallet)`; negative when clear.

    Inside a mouth the table goes on to the goal line. Written from the rules of the table, not from the product.
    """
    rp, rm = p.puck_radius, p.mallet_radius
    outside = into_post = into_mallet = -math.inf
    for i in range(rows):
        x, y = out[i, PX], out[i, PY]
        if not math.isfinite(x + y + out[i, PVX] + out[i, PVY]):
            return math.inf, math.inf, math.inf
        outside = max(outside, rp - y, y - (p.width - rp))
        if abs(y - 0.5 * p.width) >= 0.5 * p.goal_width:
            outside = max(outside, rp - x, x - (p.length - rp))
        else:
            outside = max(outside, -x, x - p.length)
        for post_x in (0.0, p.length):
            for side in (-0.5, 0.5):
                into_post = max(into_post, rp - math.hypot(x - post_x, y - 0.5 * p.width - side * p.goal_width))
        for k in range(2):
            apart = math.hypot(x - out[i, M0X + 2 * k], y - out[i, M0Y + 2 * k])
            into_mallet = max(into_mallet, rp + rm - apart)
    return outside, into_post, into_mallet
