"""The free run: from a state that is fitted to the past of a moment, the path under the volts that followed.

Friction and the lagged volts at the beginning of that past follow from the measured path and the volts before it; what
is left of the state, position and velocity of both axes and the belt's stretch, is fitted to the measured path.
"""

from __future__ import annotations

import numpy as np

from puckpilot_env.kernel import array_kernel, kernel
from sim2real.identify.gantry.motion import STATE, advance, axis_volts, lagged, slide

UNKNOWN = (0, 1, 2, 3, 6, 7)  # of a state: positions and velocities of the axes, stretch of the belt and its rate
ROUNDS = 2  # of Gauss and Newton; the state enters almost linearly, so that all use the first one's derivatives
STRETCH_STEP, SPEED_STEP = 1e-5, 1e-3  # m, m/s, differences for the derivatives


@kernel
def follow(c, t, volts, place, memory):
    """Write to `memory` (n, STATE) what is remembered at each time: lagged volts and friction along the measured path.

    t (n,) [s]; volts (n, 2) [V]: of the motors from each time until the next; place (n, 2) [m]: measured.
    """
    memory[0, :] = 0.0
    for i in range(len(t) - 1):
        duration = t[i + 1] - t[i]
        d_x, d_y = place[i + 1, 0] - place[i, 0], place[i + 1, 1] - place[i, 1]
        v_x, v_y = d_x / duration, d_y / duration
        s = memory[i + 1]
        for k in range(STATE):
            s[k] = memory[i, k]
        target_x, target_y = axis_volts(c, volts[i, 0], volts[i, 1], s)
        _, s[4] = lagged(c.fast_x, s[4], target_x, duration)
        _, s[5] = lagged(c.fast_y, s[5], target_y, duration)
        slide(c, s, d_x, d_y)
        s[0], s[1], s[2], s[3] = place[i + 1, 0], v_x, place[i + 1, 1], v_y


@kernel
def drive(c, s, t, volts, begin, end, path):
    """Advance a state `s` from time `begin` to `end`, indices of `t`; write the positions after each to `path`."""
    for i in range(begin, end):
        path[i - begin, 0], path[i - begin, 1] = s[0], s[2]
        advance(c, s, volts[i, 0], volts[i, 1], t[i + 1] - t[i])
    path[end - begin, 0], path[end - begin, 1] = s[0], s[2]


@array_kernel
def fit_state(c, t, volts, place, memory, begin, end, noise, spread, state):
    """Fit `state` (STATE,) at the time `begin` to the positions until `end`, indices of `t`.

    noise [m]: of a position; spread (2,) [m, m/s]: standard deviations, before the fit, of the belt's stretch and its
    rate.
    """
    n, unknowns = end - begin + 1, 6 if c.beyond > 0.0 else 4
    path, s = np.empty((n, 2)), np.empty(STATE)
    jacobian, r = np.zeros((2 * n, unknowns)), np.empty(2 * n)
    for k in range(STATE):
        state[k] = memory[begin, k]
    for k in range(2):
        state[2 * k + 1] = (place[end, k] - place[begin, k]) / (t[end] - t[begin])
    for round in range(ROUNDS):
        for k in range(STATE):
            s[k] = state[k]
        drive(c, s, t, volts, begin, end, path)
        for i in range(n):
            r[2 * i], r[2 * i + 1] = place[begin + i, 0] - path[i, 0], place[begin + i, 1] - path[i, 1]
        if round == 0:
            differentiate(c, t, volts, begin, end, state, path, jacobian)
        g, b = jacobian.T @ jacobian, jacobian.T @ r
        for k in range(4, unknowns):
            weight = (noise / spread[k - 4]) ** 2
            g[k, k] += weight
            b[k] -= weight * state[UNKNOWN[k]]
        step = np.linalg.solve(g, b)
        for k in range(unknowns):
            state[UNKNOWN[k]] += step[k]


@array_kernel
def differentiate(c, t, volts, begin, end, state, path, jacobian):
    """Write to `jacobian` (2 n, unknowns) how the positions from `begin` to `end`, in turn x and y, change with the
    unknowns of the `state` at `begin`; `path` (n, 2) [m]: the positions. A position itself shifts them all."""
    other, s = np.empty_like(path), np.empty(STATE)
    for k in range(jacobian.shape[1]):
        axis = UNKNOWN[k] // 2
        if UNKNOWN[k] in (0, 2):
            for i in range(len(path)):
                jacobian[2 * i + axis, k] = 1.0
            continue
        step = STRETCH_STEP if UNKNOWN[k] == 6 else SPEED_STEP
        for j in range(STATE):
            s[j] = state[j]
        s[UNKNOWN[k]] += step
        drive(c, s, t, volts, begin, end, other)
        for i in range(len(path)):
            jacobian[2 * i, k] = (other[i, 0] - path[i, 0]) / step
            jacobian[2 * i + 1, k] = (other[i, 1] - path[i, 1]) / step


@array_kernel
def free_runs(c, t, volts, place, begin, start, ahead, noise, spread, errors):
    """Write to `errors` (w, h, 2) [m] measured minus predicted positions of each window.

    begin, start (w,): indices of the first time of the past and of the moment of the prediction; ahead (w, h): of the
    times that are predicted, in order.
    """
    memory, state = np.empty((len(t), STATE)), np.empty(STATE)
    follow(c, t, volts, place, memory)
    for w in range(len(start)):
        fit_state(c, t, volts, place, memory, begin[w], start[w], noise, spread, state)
        path = np.empty((ahead[w, -1] - begin[w] + 1, 2))
        drive(c, state, t, volts, begin[w], ahead[w, -1], path)
        for h in range(ahead.shape[1]):
            for k in range(2):
                errors[w, h, k] = place[ahead[w, h], k] - path[ahead[w, h] - begin[w], k]
