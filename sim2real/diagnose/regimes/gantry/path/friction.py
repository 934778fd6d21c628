"""The change of the mallet's path by dry friction of motors and axes, whose direction is that of the motors' motion.

Under constant volts an axis has a closed form; friction is held for a step at a time.
"""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.kernel import array_kernel, kernel
from puckpilot_env.physics.effects.motor_friction import EFFECT
from sim2real.diagnose.regimes.gantry.path.friction_step import friction_step
from sim2real.diagnose.regimes.gantry.path.response import axis_of, drive_on, place
from sim2real.diagnose.regimes.gantry.tuned import GANTRY_DATA
from sim2real.diagnose.regimes.gantry.windows import StreamWindows

ROWS = EFFECT.row_names
RUN_IN, SHOWN, FEWEST, ROUNDS = range(5, 9)  # of the tuned numbers that the kernels take, after those of a step


def path_of_friction(
    p: np.void, changes: np.ndarray, volts: np.ndarray, unknown: np.ndarray, t: np.ndarray, observed: np.ndarray,
    velocity: np.ndarray, windows: StreamWindows,
) -> np.ndarray:  # fmt: skip
    """The part (n, 2) [m] of the path at the times `t` (n,) [s] that the friction of the parameters `p` causes, from
    the same start in each window; `observed` (n, 2) [m], `velocity` (n, 2) [m/s]: of the measured path; `volts` (k, 2)
    [V]: of the axes from `changes` (k,) [s] on, without friction; `unknown` (m,) [s]: where gaps in their record
    begin."""
    path = np.zeros(velocity.shape)
    sizes = np.array([float(p[row]) for row in ROWS])
    if sizes.any():
        tuned = GANTRY_DATA
        step = (tuned.dry_step, tuned.dry_longest, tuned.dry_saturated, tuned.dry_speed, tuned.dry_agreed)
        start = (tuned.run_in, tuned.start_shown, tuned.start_samples, tuned.start_rounds)
        numbers = np.array([*step, *start])
        cut = (windows.begin, windows.end, windows.parted)
        _change(p, sizes, changes, volts, unknown, t, observed, velocity, *cut, numbers, path)
    return path


@array_kernel
def _change(p, sizes, changes, volts, unknown, t, observed, velocity, begin, end, parted, numbers, path):
    """Write the displacement by friction to `path` (n, 2) [m]. The simulation continues from one window to the next,
    and starts RUN_IN before the first, because a slow measured speed has the wrong sign as often as not. It starts with
    the measured speed only where the volts before were not recorded. There, and in a window that is `parted` from the
    one before, by a push of the puck above all, the speed is corrected by what the path shows next."""
    x, y, none = axis_of(p, 0), axis_of(p, 1), np.zeros(4)
    now, gap, moment = 0, 0, -math.inf
    at_x = at_y = (0.0, 0.0, 0.0, 0.0, 0.0)
    for w in range(len(begin)):
        a, b = begin[w], end[w]
        if t[a] - moment > numbers[RUN_IN]:  # what came before that is forgotten
            moment, at_x, at_y = t[a] - numbers[RUN_IN], (0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0, 0.0)
        while gap < len(unknown) and unknown[gap] <= moment:
            gap += 1
        known = changes[0] <= moment and (gap == len(unknown) or unknown[gap] > t[a])
        while now + 1 < len(changes) and changes[now + 1] <= (moment if known else t[a]):
            now += 1
        if known:
            now, at_x, at_y = _drive(x, y, sizes, changes, volts, now, moment, t[a], at_x, at_y, numbers)
        else:
            at_x, at_y = _start(x, velocity[a, 0], volts[now, 0]), _start(y, velocity[a, 1], volts[now, 1])
        if parted[w] or not known:
            at_x, at_y = _corrected(x, y, sizes, changes, volts, now, t[a:b], observed[a:b], at_x, at_y, numbers)
        without, to_x, to_y = now, at_x, at_y
        moment = t[a]
        for i in range(a, b):
            without, to_x, to_y = _drive(x, y, none, changes, volts, without, moment, t[i], to_x, to_y, numbers)
            now, at_x, at_y = _drive(x, y, sizes, changes, volts, now, moment, t[i], at_x, at_y, numbers)
            moment = t[i]
            path[i, 0], path[i, 1] = place(x, at_x) - place(x, to_x), place(y, at_y) - place(y, to_y)


@kernel
def _drive(x, y, sizes, changes, volts, now, moment, until, at_x, at_y, numbers):
    """The number of the volts in use and the states of both axes at `until` [s], from those at `moment` [s]; x, y: the
    axes' constants."""
    while moment < until - 1e-9:
        end = max(min(until, changes[now + 1]), moment) if now + 1 < len(changes) else until
        most = end - moment
        held, lost_x, lost_y = friction_step(x, y, sizes, at_x, at_y, volts[now, 0], volts[now, 1], most, numbers)
        at_x = drive_on(x, at_x, volts[now, 0] - lost_x, held)
        at_y = drive_on(y, at_y, volts[now, 1] - lost_y, held)
        moment = end if held == most else moment + held
        while now + 1 < len(changes) and changes[now + 1] <= moment:
            now += 1
    return now, at_x, at_y


@kernel
def _corrected(x, y, sizes, changes, volts, now, t, observed, at_x, at_y, numbers):
    """The states of both axes at t[0] with such slow modes that the path SHOWN from there on fits `observed` (n, 2) [m]
    best, of FEWEST samples at least; the volts before do not tell what pushed the mallet. In ROUNDS, since friction's
    direction depends on the speed, and the path on friction."""
    for _ in range(int(numbers[ROUNDS])):
        place_now, moment, sx, sy = now, t[0], at_x, at_y
        sums_x = sums_y = (0.0, 0.0, 0.0, 0.0, 0.0)
        for i in range(len(t)):
            if t[i] - t[0] > numbers[SHOWN] and sums_x[0] >= numbers[FEWEST]:
                break
            place_now, sx, sy = _drive(x, y, sizes, changes, volts, place_now, moment, t[i], sx, sy, numbers)
            moment = t[i]
            sums_x = _with(sums_x, math.exp(-x[0] * (t[i] - t[0])), observed[i, 0] - sx[0] - sx[1] - sx[2])
            sums_y = _with(sums_y, math.exp(-y[0] * (t[i] - t[0])), observed[i, 1] - sy[0] - sy[1] - sy[2])
        if sums_x[0] < numbers[FEWEST]:
            break
        at_x = (at_x[0], at_x[1] + _slope(sums_x), at_x[2], at_x[3], at_x[4])
        at_y = (at_y[0], at_y[1] + _slope(sums_y), at_y[2], at_y[3], at_y[4])
    return at_x, at_y


@kernel
def _with(sums, mode, off):
    """The sums of a straight line's fit of `off` over `mode` with one more sample."""
    return sums[0] + 1.0, sums[1] + mode, sums[2] + mode * mode, sums[3] + off, sums[4] + mode * off


@kernel
def _slope(sums):
    """The slope of the line."""
    return (sums[0] * sums[4] - sums[1] * sums[3]) / (sums[0] * sums[2] - sums[1] * sums[1])


@kernel
def _start(c, velocity, volts):
    """The state at 0 with a velocity [m/s], whose fast mode is as long constant `volts` [V] leave it."""
    slow_rate, _, rest_gain, slow_gain, fast_gain = c[:5]
    slow = (rest_gain * volts - velocity) / slow_rate - slow_gain * volts
    return -slow - fast_gain * volts, slow, fast_gain * volts, 0.0, velocity
