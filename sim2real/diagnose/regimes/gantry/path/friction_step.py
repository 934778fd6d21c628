"""Dry friction of motors and axes over one step of the gantry: the volts that it takes, and for how long they hold.

Friction is size * tanh(speed / creep), of the speeds of both motors and both axes. It is stiff where one of them
sticks. A step there is linearly implicit (Rosenbrock, Comput. J. 5, 1963) if friction at its end is then what it was
taken for, and else short and explicit.
"""

from __future__ import annotations

import math

from puckpilot_env.kernel import kernel
from puckpilot_env.physics.gantry.decay import fade

STEP, LONGEST, SATURATED, CREEP, AGREED = range(5)  # of the tuned numbers that the kernels take


@kernel
def friction_step(x, y, sizes, at_x, at_y, volts_x, volts_y, most, numbers):
    """How long [s] friction can be held, of `most` [s], and the volts that it takes from both axes meanwhile.

    x, y: constants of the axes, from `axis_of`; sizes: of the left and right motor and the x and y axis [V]; at_x,
    at_y: states of the axes, as in `drive_on`, under `volts_x`, `volts_y` [V].
    """
    if sizes[0] == sizes[1] == sizes[2] == sizes[3] == 0.0:
        return most, 0.0, 0.0
    speeds = _speed(x, at_x, volts_x, 0.0), _speed(y, at_y, volts_y, 0.0)
    shares = _shares(speeds, numbers[CREEP])
    lost_x, lost_y = _lost(sizes, shares)
    left_x, left_y = volts_x - lost_x, volts_y - lost_y
    pull_x, pull_y = _pull(x, at_x, left_x), _pull(y, at_y, left_y)
    step = min(most, _until_reversal(speeds, pull_x, pull_y, numbers))
    if step > numbers[STEP]:
        ends = _speed(x, at_x, left_x, step), _speed(y, at_y, left_y, step)
        gains = _gain(x, step), _gain(y, step)
        more_x, more_y, ends = _implicit(sizes, shares, speeds, ends, gains, numbers[CREEP])
        then_x, then_y = _lost(sizes, _shares(ends, numbers[CREEP]))
        if abs(then_x - lost_x - more_x) + abs(then_y - lost_y - more_y) < numbers[AGREED]:
            return step, lost_x + more_x, lost_y + more_y
    return min(most, numbers[STEP]), lost_x, lost_y


@kernel
def _implicit(sizes, shares, speeds, ends, gains, creep):
    """The further volts lost to friction that grows linearly with the speeds from `speeds` on, at the end of a step,
    and the speeds [m/s] there; `ends`: those without it, `gains` [m/s/V]: what a volt adds to them."""
    left, right, along_x, along_y = (
        sizes[0] * (1.0 - shares[0] * shares[0]) / creep, sizes[1] * (1.0 - shares[1] * shares[1]) / creep,
        sizes[2] * (1.0 - shares[2] * shares[2]) / creep, sizes[3] * (1.0 - shares[3] * shares[3]) / creep,
    )  # fmt: skip
    xx, xy, yy = left + right + along_x, right - left, left + right + along_y
    a, b, c, d = 1.0 + gains[0] * xx, gains[0] * xy, gains[1] * xy, 1.0 + gains[1] * yy
    off_x, off_y = ends[0] - speeds[0], ends[1] - speeds[1]
    by_x, by_y = (d * off_x - b * off_y) / (a * d - b * c), (a * off_y - c * off_x) / (a * d - b * c)
    return xx * by_x + xy * by_y, xy * by_x + yy * by_y, (speeds[0] + by_x, speeds[1] + by_y)


@kernel
def _speed(c, state, volts, after):
    """The speed [m/s] of an axis `after` [s] under constant `volts` [V]: that of its modes, of which the fast one
    follows the volts."""
    slow, fast = state[1] + c[3] * volts, state[2] - c[4] * volts
    if after > 0.0:
        slow, fast = slow * math.exp(-c[0] * after), fast * fade(c[1], after)
    return c[2] * volts - c[0] * slow - c[1] * fast


@kernel
def _gain(c, after):
    """By how much [m/s/V] a volt, held for `after` [s], changes the speed of an axis."""
    return c[2] - c[0] * c[3] * math.exp(-c[0] * after) + c[1] * c[4] * fade(c[1], after)


@kernel
def _pull(c, state, volts):
    """The most [m/s^2] that an axis may accelerate under constant `volts` [V]: both its modes die out."""
    return c[0] * c[0] * abs(state[1] + c[3] * volts) + c[1] * c[1] * abs(state[2] - c[4] * volts)


@kernel
def _until_reversal(speeds, pull_x, pull_y, numbers):
    """Half the time [s] in which the first speed at which friction is constant may vanish, at accelerations of
    `pull_x`, `pull_y` [m/s^2], and LONGEST at most while something sticks."""
    (vx, vy), both = speeds, pull_x + pull_y
    least = min(_vanishing(vx, pull_x, numbers), _vanishing(vy, pull_y, numbers))
    return min(least, _vanishing(vx - vy, both, numbers), _vanishing(vx + vy, both, numbers))


@kernel
def _vanishing(speed, pull, numbers):
    """Half the time [s] in which a speed may vanish at which friction is constant, LONGEST where it is not."""
    constant = abs(speed) > numbers[SATURATED] * numbers[CREEP]
    return 0.5 * abs(speed) / max(pull, 1e-9) if constant else numbers[LONGEST]


@kernel
def _shares(speeds, creep):
    """Friction of the left and right motor and of the x and y axis, each as a share of its size."""
    vx, vy = speeds
    return math.tanh((vx - vy) / creep), math.tanh((-vx - vy) / creep), math.tanh(vx / creep), math.tanh(vy / creep)


@kernel
def _lost(sizes, shares):
    """The volts that friction takes from both axes: V_x = left - right, V_y = -(left + right)."""
    left, right, along_x, along_y = (
        sizes[0] * shares[0], sizes[1] * shares[1], sizes[2] * shares[2], sizes[3] * shares[3]
    )  # fmt: skip
    return left - right + along_x, -left - right + along_y
