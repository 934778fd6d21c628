"""Simulate glides: paths and accelerations under a law by the simulator's own sliding, the linear response of a path to
small accelerations, and the extrapolation beyond a glide's frames to an unobserved contact."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from puckpilot_env.kernel import array_kernel, kernel
from puckpilot_env.physics import compose
from puckpilot_env.physics.sliding.slide import slide
from sim2real.diagnose.engine.problem import record_of
from sim2real.diagnose.regimes.sliding.forces.motion import Motion
from sim2real.diagnose.regimes.sliding.tuned import SLIDING

X, Y, VX, VY, SPIN = range(5)


@kernel
def trace(p, first, t, starts, pucks, path):
    """Write the motion of each glide at its frames.

    `path` (n, 4): place [m] and velocity [m/s]; `starts` (g, 5): place, velocity and spin [rad/s]; `first` (g + 1,):
    the first frame of each glide, and n; `t` (n,) [s]; `p`: a record of parameters; `pucks`: an array of at least one
    record of `advance.PUCK`, which is overwritten.
    """
    puck = pucks[0]
    for g in range(len(first) - 1):
        puck.x, puck.y, puck.vx, puck.vy = starts[g, X], starts[g, Y], starts[g, VX], starts[g, VY]
        puck.spin = starts[g, SPIN]
        for i in range(first[g], first[g + 1]):
            if i > first[g]:
                slide(puck, p, t[i - 1], t[i] - t[i - 1])
            path[i, X], path[i, Y], path[i, VX], path[i, VY] = puck.x, puck.y, puck.vx, puck.vy


def accelerations(values: Mapping[str, float], motion: Motion) -> np.ndarray:
    """Accelerations (n, 2) [m/s^2] of a puck without spin due to friction and all effects of a law, without drag."""
    found = np.empty_like(motion.velocity)
    size = {"length": float(motion.size[0]), "width": float(motion.size[1])}
    _accelerations(record_of({**values, **size}), motion.t, motion.place, motion.velocity, found)
    return found


@kernel
def _accelerations(p, t, place, velocity, found):
    for i in range(len(t)):
        x, y, vx, vy = place[i, 0], place[i, 1], velocity[i, 0], velocity[i, 1]
        found[i, 0], found[i, 1] = _acceleration(p, t[i], x, y, vx, vy)


@kernel
def _acceleration(p, t, x, y, vx, vy):
    """Acceleration [m/s^2] of a puck without spin by a law, without drag."""
    ax, ay = compose.acceleration(p, t, x, y, vx, vy, 0.0)
    brake = max(compose.friction(p, t, x, y, vx, vy, p.friction), 0.0)
    speed = max(math.sqrt(vx * vx + vy * vy), 1e-9)
    return ax - brake * vx / speed, ay - brake * vy / speed


@array_kernel
def linear_response(first, t, path, friction, drag, force, moved, moving):
    """Write the displacements `moved` (n, 2, k) [m] of a `path` (n, 4) and their rates `moving` (n, 2, k) [m/s] due to
    small accelerations `force` (n, 2, k) [m/s^2].

    The linearized motion is d'' = (da/dv) d' + force with the baseline's da/dv, from rest at each glide's first frame;
    it is integrated by the implicit trapezoidal rule between frames, along and across the motion, since the equation of
    the heading is stiff for a slow puck.
    """
    k = force.shape[2]
    dvx, dvy = np.zeros(k), np.zeros(k)
    for g in range(len(first) - 1):
        dvx[:] = 0.0
        dvy[:] = 0.0
        moved[first[g]] = 0.0
        moving[first[g]] = 0.0
        for i in range(first[g], first[g + 1] - 1):
            h = t[i + 1] - t[i]
            vx, vy = 0.5 * (path[i, VX] + path[i + 1, VX]), 0.5 * (path[i, VY] + path[i + 1, VY])
            speed = np.sqrt(vx * vx + vy * vy) + 1e-9
            ux, uy = vx / speed, vy / speed
            across, along = friction / speed + drag * speed, 2.0 * drag * speed
            implicit_along, implicit_across = 1.0 / (1.0 + 0.5 * h * along), 1.0 / (1.0 + 0.5 * h * across)
            for j in range(k):
                fx, fy = 0.5 * (force[i, 0, j] + force[i + 1, 0, j]), 0.5 * (force[i, 1, j] + force[i + 1, 1, j])
                gain_along = (ux * (fx - along * dvx[j]) + uy * (fy - along * dvy[j])) * implicit_along
                gain_across = (ux * (fy - across * dvy[j]) - uy * (fx - across * dvx[j])) * implicit_across
                ax, ay = ux * gain_along - uy * gain_across, uy * gain_along + ux * gain_across
                moved[i + 1, 0, j] = moved[i, 0, j] + h * (dvx[j] + 0.5 * h * ax)
                moved[i + 1, 1, j] = moved[i, 1, j] + h * (dvy[j] + 0.5 * h * ay)
                dvx[j] += h * ax
                dvy[j] += h * ay
                moving[i + 1, 0, j], moving[i + 1, 1, j] = dvx[j], dvy[j]


def extrapolated(
    record: np.ndarray, t: float, place: np.ndarray, velocity: np.ndarray, more: np.ndarray, duration: float
) -> tuple[np.ndarray, np.ndarray]:
    """Place (2,) [m] and velocity (2,) [m/s] `duration` [s] after `t` [s] (before it if negative), under the law of the
    parameters `record` (1,) and a constant acceleration `more` (2,) [m/s^2]."""
    state = np.concatenate([place, velocity])
    steps = max(int(np.ceil(abs(duration) / SLIDING.runge_kutta_step)), 1)
    _carry_on(record, t, state, more, duration / steps, steps)
    return state[:2], state[2:]


@array_kernel
def _carry_on(record, t, state, more, h, steps):
    """Take `state` (4,), place and velocity, so many steps of `h` [s] on, by the Runge-Kutta method of fourth order."""
    p, slopes, at = record[0], np.empty((4, 4)), np.empty(4)
    for step in range(steps):
        for k in range(4):
            part = 0.0 if k == 0 else 1.0 if k == 3 else 0.5
            for i in range(4):
                at[i] = state[i] + part * h * slopes[max(k - 1, 0), i] if k else state[i]
            ax, ay = _acceleration(p, t + (step + part) * h, at[0], at[1], at[2], at[3])
            speed = math.sqrt(at[2] * at[2] + at[3] * at[3])
            slopes[k, 0], slopes[k, 1] = at[2], at[3]
            slopes[k, 2] = ax - p.drag * speed * at[2] + more[0]
            slopes[k, 3] = ay - p.drag * speed * at[3] + more[1]
        for i in range(4):
            state[i] += h / 6.0 * (slopes[0, i] + 2.0 * slopes[1, i] + 2.0 * slopes[2, i] + slopes[3, i])
