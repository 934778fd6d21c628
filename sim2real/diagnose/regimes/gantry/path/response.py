"""The response of one axis of the gantry to volts in each window, and the residuals.

Every window starts from an unknown state: the modes of the axis and of the belt's ringing. These enter linearly, so
they are projected out of the residuals, together with one column for each switch whose tick is uncertain.
"""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.kernel import array_kernel, kernel
from puckpilot_env.physics.effects import backlash, belt_compliance
from puckpilot_env.physics.gantry.decay import fade
from puckpilot_env.physics.gantry.mallet import axis_coefficients, axis_constants
from sim2real.statistics.projection import project_out

MOST_UNCERTAIN = 24  # most uncertain switches of one window that get a column
STARTS = 5  # columns of a start: rest, slow and fast mode, and two of the ringing
PLAY_ROUNDS = 3  # iterations, because path and play depend on each other


@kernel
def axis_of(p, axis):
    """Constants of axis 0 (x) or 1 (y) and of its belt: those of `axis_constants`, then w [rad/s] and zeta."""
    c5, c6, c7 = axis_coefficients(p, axis)
    slow_rate, fast_rate, rest_gain, slow_gain, fast_gain = axis_constants(c5, c6, c7, p.pulley_radius)
    return slow_rate, fast_rate, rest_gain, slow_gain, fast_gain, 2.0 * math.pi * p.belt_hz, p.belt_zeta


@kernel
def drive_on(c, state, volts, duration):
    """Advance a state (rest, slow, fast, x, v) [m, m/s] by `duration` [s] at constant `volts`; `c` from `axis_of`."""
    slow_rate, fast_rate, rest_gain, slow_gain, fast_gain, w, zeta = c
    rest, slow, fast, x, v = state
    slow_end, fast_end = -slow_gain * volts, fast_gain * volts
    slow_part, fast_part = slow - slow_end, fast - fast_end
    slow_next = slow_part * math.exp(-slow_rate * duration)
    fast_next = fast_part * fade(fast_rate, duration)
    rest_next = rest + rest_gain * volts * duration
    if w > 0.0:
        by_slow, by_fast = belt_compliance.transfer(w, zeta, slow_rate), belt_compliance.transfer(w, zeta, fast_rate)
        x -= rest + slow_end + fast_end + by_slow * slow_part + by_fast * fast_part
        v -= rest_gain * volts - slow_rate * by_slow * slow_part - fast_rate * by_fast * fast_part
        x, v = belt_compliance.ring(w, zeta, x, v, duration)
        x += rest_next + slow_end + fast_end + by_slow * slow_next + by_fast * fast_next
        v += rest_gain * volts - slow_rate * by_slow * slow_next - fast_rate * by_fast * fast_next
    return rest_next, slow_end + slow_next, fast_end + fast_next, x, v


@kernel
def place(c, state):
    """The mallet's position [m] in a `state`."""
    return state[3] if c[5] > 0.0 else state[0] + state[1] + state[2]


@kernel
def drive_window(c, changes, volts, now, t, path):
    """Write to `path` (n,) [m] the positions at the times `t` (n,) [s] of one window, from rest at 0.

    `changes` (k,) [s]: start of each of `volts` (k,) [V]; `now`: index of the volts at the start of the window.
    """
    state, moment = (0.0, 0.0, 0.0, 0.0, 0.0), t[0]
    for i in range(len(t)):
        while now + 1 < len(changes) and changes[now + 1] <= t[i]:
            state = drive_on(c, state, volts[now], max(changes[now + 1] - moment, 0.0))
            moment = max(changes[now + 1], moment)
            now += 1
        state = drive_on(c, state, volts[now], t[i] - moment)
        moment = t[i]
        path[i] = place(c, state)


@kernel
def start_columns(c, t, columns):
    """Write to `columns` (n, STARTS) the free responses of the starting modes at the times `t` (n,) [s] of a window."""
    for i in range(len(t)):
        age = t[i] - t[0]
        columns[i, 0] = 1.0
        columns[i, 1] = math.exp(-c[0] * age)
        columns[i, 2] = fade(c[1], age)
        columns[i, 3], columns[i, 4] = 0.0, 0.0
        if c[5] > 0.0:
            columns[i, 3], _ = belt_compliance.ring(c[5], c[6], 1.0, 0.0, age)
            columns[i, 4], _ = belt_compliance.ring(c[5], c[6], 0.0, c[5], age)


@kernel
def uncertain_switch_column(c, moment, t, column):
    """Write to `column` (n,) the derivative of the path at `t` (n,) [s] by the time of a switch at `moment` [s]."""
    for i in range(len(t)):
        age = t[i] - moment
        column[i] = 0.0
        if age > 0.0:
            column[i] = c[2] - c[3] * c[0] * math.exp(-c[0] * age) + c[4] * c[1] * fade(c[1], age)


@kernel
def turning_point(before, here, after):
    """Place and time (in samples relative to the middle one) of the vertex of the parabola through three samples around
    a reversal; the middle sample and 0 if there is none."""
    if (here - before) * (after - here) >= 0.0:
        return here, 0.0
    bend, slope = before - 2.0 * here + after, 0.5 * (after - before)
    return here - 0.5 * slope * slope / bend, -slope / bend


@kernel
def shift_by_play(gap, motor, play):
    """Write to `play` (n,) [m] the mallet's position minus that of the `motor` (n,) [m] with a backlash of `gap` [m].

    On entry, `play[0]` must hold the last value.
    """
    mallet = motor[0] + play[0]
    for i in range(len(motor)):
        extreme, when = motor[i], 0.0
        if 0 < i < len(motor) - 1:
            extreme, when = turning_point(motor[i - 1], motor[i], motor[i + 1])
        if when < 0.0:
            mallet = backlash.carried(gap, mallet, extreme)
        mallet = backlash.carried(gap, mallet, motor[i])
        play[i] = mallet - motor[i]
        if when > 0.0:
            mallet = backlash.carried(gap, mallet, extreme)


@array_kernel
def axis_residuals(p, axis, changes, volts, uncertain, t, observed, dry, weight, begin, end, extra, out):
    """Write to `out` (samples, 1 + m) the weighted residual and columns of `extra` (samples, m) [m], with the starts
    projected out.

    changes (k,) [s], volts (k,) [V]: at the motors; uncertain: indices of uncertain switches; t [s], observed [m],
    dry [m] (samples,): what friction adds to the path; weight [1/m] (samples,): of the encoders; begin, end (windows,):
    first sample of each window, and one past its last.
    """
    c, gap = axis_of(p, axis), p.backlash_gap
    carried, next_uncertain = 0.0, 0
    now = 0
    for w in range(len(begin)):
        a, b = begin[w], end[w]
        while now + 1 < len(changes) and changes[now + 1] <= t[a]:
            now += 1
        times, n = t[a:b], b - a
        columns, path = np.empty((n, STARTS + MOST_UNCERTAIN)), np.empty(n)
        drive_window(c, changes, volts, now, times, path)
        start_columns(c, times, columns)
        count = STARTS if c[5] > 0.0 else 3
        while next_uncertain < len(uncertain) and changes[uncertain[next_uncertain]] <= t[a]:
            next_uncertain += 1
        index = next_uncertain
        while index < len(uncertain) and changes[uncertain[index]] < t[b - 1] and count < STARTS + MOST_UNCERTAIN:
            uncertain_switch_column(c, changes[uncertain[index]] - (times[1] - times[0]), times, columns[:, count])
            count += 1
            index += 1
        for i in range(n):
            columns[i, :count] *= weight[a + i]
            out[a + i, 1:] = extra[a + i] * weight[a + i]
            path[i] += dry[a + i]
            out[a + i, 0] = (observed[a + i] - path[i]) * weight[a + i]
        project_out(columns, count, out[a:b])
        if gap > 0.0:
            if w == 0 or begin[w] != end[w - 1]:
                carried = -0.5 * gap * np.sign(observed[min(a + n // 4, b - 1)] - observed[a])
            motor, play, again = np.empty(n), np.empty(n), np.empty((n, 1))
            for i in range(n):
                motor[i] = observed[a + i] - out[a + i, 0] / weight[a + i]
            for _ in range(PLAY_ROUNDS):
                play[0] = carried
                shift_by_play(gap, motor, play)
                for i in range(n):
                    again[i, 0] = (observed[a + i] - path[i] - play[i]) * weight[a + i]
                project_out(columns, count, again)
                for i in range(n):
                    out[a + i, 0] = again[i, 0]
                    motor[i] = observed[a + i] - play[i] - again[i, 0] / weight[a + i]
            carried = play[n - 1]


@kernel
def sampled_response(p, axis, inputs, t, begin, end, out):
    """Write to `out` (samples, m) [m] the responses of a rigid axis to `inputs` (samples, m) [V], held constant between
    samples."""
    slow_rate, fast_rate, rest_gain, slow_gain, fast_gain, _, _ = axis_of(p, axis)
    c = (slow_rate, fast_rate, rest_gain, slow_gain, fast_gain, 0.0, 0.0)
    for w in range(len(begin)):
        for m in range(inputs.shape[1]):
            state = (0.0, 0.0, 0.0, 0.0, 0.0)
            out[begin[w], m] = 0.0
            for i in range(begin[w] + 1, end[w]):
                state = drive_on(c, state, inputs[i - 1, m], t[i] - t[i - 1])
                out[i, m] = place(c, state)
