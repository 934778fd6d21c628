"""The interface of the reference: one call from a start state and plans to a trace."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sim2real.study.independent_table.physics.gantry import MOTOR
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.physics.march import LOG_COLUMNS, march
from sim2real.study.independent_table.physics.table import GOAL, MALLET, NAMES, POST
from sim2real.study.independent_table.physics.volts import Plans, schedule

LOG_ROWS = 10_000
LONG_AGO = 1e3  # s since the last contact of a released puck


class Contact(NamedTuple):
    """One contact. `kind` is wall, post, mallet or goal; `which` names it: "x0", "yW", post "x0y0", mallet "0".

    `x`, `y` and `speed` are the puck's at contact, before the impulse; `closing` is the component of the relative
    velocity along the normal (nx, ny), which points from the obstacle to the puck.
    """

    t: float
    kind: str
    which: str
    x: float
    y: float
    speed: float
    closing: float
    nx: float
    ny: float


@dataclass(frozen=True)
class Trace:
    """The simulated motion, every `sample` seconds. After a goal the puck is NaN.

    `near_miss` [m] is the smallest gap at which the puck passed a post or mallet without contact; if it is tiny,
    rounding decides whether there is a contact. `end_puck` and `end_mallets` can start the next run.
    """

    t: np.ndarray  # (n,)
    puck: np.ndarray  # (n, 4): x, y, vx, vy
    spin: np.ndarray  # (n,)
    mallets: np.ndarray  # (k, n, 6): x, x', x'', y, y', y''; with a belt or gap also those of its motors
    contacts: list[Contact]
    unlogged: int  # contacts beyond the log's LOG_ROWS, as of a puck that is jammed for long
    near_miss: float
    end_puck: np.ndarray  # (6,): x, y, vx, vy, spin, seconds since its last contact
    end_mallets: np.ndarray  # (k, 6 or 12)


def run(
    law: Law,
    puck: Sequence[float] | np.ndarray | None = None,
    mallets: Sequence[Sequence[float]] | np.ndarray = (),
    plans: Sequence[Plans] | None = None,
    duration: float = 1.0,
    dt: float = 1e-5,
    sample: float = 1e-3,
    clock: float = 0.0,
) -> Trace:
    """Simulate `duration` seconds.

    `puck`: (x, y, vx, vy[, spin[, seconds since its last contact]]), or None for no puck. `mallets`: up to two starts,
    (x, y), (x, vx, ax, y, vy, ay), or the twelve numbers of the end of another run.
    `plans`: one for each mallet: (Vx, Vy, tx1, ty1, tx2, ty2) in signed volts and seconds, None (no voltage), or a
    list of (start, plan) in order of time. `clock`: time at the start, for laws that change with time (times of plans
    and trace are relative to the start).
    """
    plans = [None] * len(mallets) if plans is None else plans
    if len(mallets) > 2 or len(plans) != len(mallets):
        raise ValueError(f"expected up to two mallets and a plan for each, got {len(mallets)} and {len(plans)} plans")
    if not (dt > 0.0 and sample > 0.0 and duration >= 0.0):
        raise ValueError(f"expected dt > 0, sample > 0, duration >= 0, got {dt}, {sample}, {duration}")
    end_puck = np.full(6, np.nan)
    if puck is not None:
        end_puck[:] = 0.0, 0.0, 0.0, 0.0, 0.0, LONG_AGO
        end_puck[: len(puck)] = puck
    end_mallets = begin(law, mallets)
    times, volts = schedule(law, plans)
    rows = int(duration / sample + 1e-9) + 1
    out_puck, out_mallets = np.full((rows, 6), np.nan), np.full((rows, *end_mallets.shape), np.nan)
    log = np.zeros((LOG_ROWS, LOG_COLUMNS))
    count, near_miss = march(
        law.numbers(), end_puck, end_mallets, times, volts, clock, duration, dt, sample, out_puck, out_mallets, log
    )
    return Trace(
        t=np.arange(rows) * sample,
        puck=out_puck[:, :4],
        spin=out_puck[:, 4],
        mallets=np.ascontiguousarray(out_mallets.swapaxes(0, 1)),
        contacts=[contact(row) for row in log[:count]],
        unlogged=max(0, count - LOG_ROWS),
        near_miss=float(near_miss),
        end_puck=end_puck,
        end_mallets=end_mallets,
    )


def begin(law: Law, mallets: Sequence[Sequence[float]] | np.ndarray) -> np.ndarray:
    """States (k, 6) of the mallets; (k, 12) with the motors' states if the law has a belt or a gap between them."""
    if law.belt_hz > 0.0 and law.backlash > 0.0:
        raise ValueError("belt_hz and backlash are both above 0 in one law: expected at most one of them")
    separate = law.belt_hz > 0.0 or law.backlash > 0.0
    states = np.zeros((len(mallets), 2 * MOTOR if separate else MOTOR))
    for state, start in zip(states, mallets, strict=True):
        if len(start) == 2:
            state[[0, 3]] = start
        else:
            state[: len(start)] = start
        if separate and len(start) <= MOTOR:
            state[MOTOR:] = state[:MOTOR]
    return states


def contact(row: np.ndarray) -> Contact:
    """Convert a row of the log to a `Contact`."""
    which = int(row[1])
    kind = "wall" if which < POST else "post" if which < GOAL else "goal" if which < MALLET else "mallet"
    t, _, x, y, speed, closing, nx, ny = (float(value) for value in row)
    return Contact(t, kind, NAMES[which], x, y, speed, closing, nx, ny)
