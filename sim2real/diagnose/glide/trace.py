"""Paths of glides under a law, by the simulator's own sliding, and how small forces would bend them."""

from __future__ import annotations

import numpy as np

from puckpilot_env.kernel import array_kernel, kernel
from puckpilot_env.physics.slide import slide

X, Y, VX, VY, SPIN = range(5)


@kernel
def trace(p, first, t, starts, pucks, path):
    """Write the motion of each glide at its frames: path (n, 4) from starts (g, 5), place [m], velocity [m/s], spin.

    `p` is a record of parameters, `pucks` an array of at least one record of `advance.PUCK` to work with.
    """
    puck = pucks[0]
    for g in range(len(first) - 1):
        puck.x, puck.y, puck.vx, puck.vy = starts[g, X], starts[g, Y], starts[g, VX], starts[g, VY]
        puck.spin = starts[g, SPIN]
        for i in range(first[g], first[g + 1]):
            if i > first[g]:
                slide(puck, p, t[i - 1], t[i] - t[i - 1])
            path[i, X], path[i, Y], path[i, VX], path[i, VY] = puck.x, puck.y, puck.vx, puck.vy


@array_kernel
def bend(first, t, path, friction, drag, force, moved, moving):
    """Displacements moved (n, 2, k) [m], and their rates moving (n, 2, k) [m/s], that small accelerations force
    (n, 2, k) [m/s^2] make along `path` (n, 4).

    The linearised motion about the path, d'' = (da/dv) d' + force with the baseline's da/dv, from rest at the glide's
    first frame, by the trapezium rule between frames.
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
            axx = -across * (1.0 - ux * ux) - along * ux * ux
            axy = (across - along) * ux * uy
            ayy = -across * (1.0 - uy * uy) - along * uy * uy
            limit = 1.0 / (1.0 + 0.5 * h * across)  # implicit where a slow puck's heading is hard to turn
            for j in range(k):
                fx, fy = 0.5 * (force[i, 0, j] + force[i + 1, 0, j]), 0.5 * (force[i, 1, j] + force[i + 1, 1, j])
                ax = (axx * dvx[j] + axy * dvy[j] + fx) * limit
                ay = (axy * dvx[j] + ayy * dvy[j] + fy) * limit
                moved[i + 1, 0, j] = moved[i, 0, j] + h * (dvx[j] + 0.5 * h * ax)
                moved[i + 1, 1, j] = moved[i, 1, j] + h * (dvy[j] + 0.5 * h * ay)
                dvx[j] += h * ax
                dvy[j] += h * ay
                moving[i + 1, 0, j], moving[i + 1, 1, j] = dvx[j], dvy[j]
