"""One step of a puck's way under forces: fifth order, with an estimate of its error (Dormand, Prince, J. Comput. Appl.
Math. 6, 1980, table 2: RK5(4)7M)."""

from __future__ import annotations

import math

from puckpilot_env.kernel import inlined_kernel
from puckpilot_env.physics.sliding.force import acceleration


@inlined_kernel
def step(puck, p, t, ax, ay, h, free_x, free_y):
    """`(x, y, vx, vy, bx, by, error)` after `h` [s] from the acceleration `a`, with the acceleration `b` there.

    `error` [m/s]: by how much the velocities of fifth and fourth order differ. `free` as in `force.acceleration`.
    """
    x, y, vx, vy, turned = puck.x, puck.y, puck.vx, puck.vy, puck.turned
    s2, s3, s4, s5, s6 = puck.spin, puck.spin, puck.spin, puck.spin, puck.spin
    if puck.spin != 0.0:
        tenth = math.exp(-0.1 * p.spin_decay * h)
        fifth = tenth * tenth
        most = fifth * fifth * fifth * fifth
        s2, s3, s4, s6 = s2 * fifth, s3 * fifth * tenth, s4 * most, s6 * most * fifth
        s5 *= math.exp(-8.0 / 9.0 * p.spin_decay * h)

    k = h / 5.0
    vx2, vy2 = vx + k * ax, vy + k * ay
    ax2, ay2 = acceleration(p, turned, t + k, x + k * vx, y + k * vy, vx2, vy2, s2, free_x, free_y)

    k, k1, k2 = 0.3 * h, 3.0 / 40.0 * h, 9.0 / 40.0 * h
    vx3, vy3 = vx + k1 * ax + k2 * ax2, vy + k1 * ay + k2 * ay2
    x3, y3 = x + k1 * vx + k2 * vx2, y + k1 * vy + k2 * vy2
    ax3, ay3 = acceleration(p, turned, t + k, x3, y3, vx3, vy3, s3, free_x, free_y)

    k, k1, k2, k3 = 0.8 * h, 44.0 / 45.0 * h, -56.0 / 15.0 * h, 32.0 / 9.0 * h
    vx4, vy4 = vx + k1 * ax + k2 * ax2 + k3 * ax3, vy + k1 * ay + k2 * ay2 + k3 * ay3
    x4, y4 = x + k1 * vx + k2 * vx2 + k3 * vx3, y + k1 * vy + k2 * vy2 + k3 * vy3
    ax4, ay4 = acceleration(p, turned, t + k, x4, y4, vx4, vy4, s4, free_x, free_y)

    k, k1, k2, k3, k4 = (
        8.0 / 9.0 * h,
        19372.0 / 6561.0 * h,
        -25360.0 / 2187.0 * h,
        64448.0 / 6561.0 * h,
        -212.0 / 729.0 * h,
    )
    vx5, vy5 = vx + k1 * ax + k2 * ax2 + k3 * ax3 + k4 * ax4, vy + k1 * ay + k2 * ay2 + k3 * ay3 + k4 * ay4
    x5, y5 = x + k1 * vx + k2 * vx2 + k3 * vx3 + k4 * vx4, y + k1 * vy + k2 * vy2 + k3 * vy3 + k4 * vy4
    ax5, ay5 = acceleration(p, turned, t + k, x5, y5, vx5, vy5, s5, free_x, free_y)

    k1, k2, k3, k4, k5 = (
        9017.0 / 3168.0 * h,
        -355.0 / 33.0 * h,
        46732.0 / 5247.0 * h,
        49.0 / 176.0 * h,
        -5103.0 / 18656.0 * h,
    )
    vx6 = vx + k1 * ax + k2 * ax2 + k3 * ax3 + k4 * ax4 + k5 * ax5
    vy6 = vy + k1 * ay + k2 * ay2 + k3 * ay3 + k4 * ay4 + k5 * ay5
    x6 = x + k1 * vx + k2 * vx2 + k3 * vx3 + k4 * vx4 + k5 * vx5
    y6 = y + k1 * vy + k2 * vy2 + k3 * vy3 + k4 * vy4 + k5 * vy5
    ax6, ay6 = acceleration(p, turned, t + h, x6, y6, vx6, vy6, s6, free_x, free_y)

    k1, k3, k4, k5, k6 = 35.0 / 384.0 * h, 500.0 / 1113.0 * h, 125.0 / 192.0 * h, -2187.0 / 6784.0 * h, 11.0 / 84.0 * h
    x += k1 * vx + k3 * vx3 + k4 * vx4 + k5 * vx5 + k6 * vx6
    y += k1 * vy + k3 * vy3 + k4 * vy4 + k5 * vy5 + k6 * vy6
    vx += k1 * ax + k3 * ax3 + k4 * ax4 + k5 * ax5 + k6 * ax6
    vy += k1 * ay + k3 * ay3 + k4 * ay4 + k5 * ay5 + k6 * ay6
    bx, by = acceleration(p, turned, t + h, x, y, vx, vy, s6, free_x, free_y)

    e1, e3, e4, e5, e6, e7 = (
        71.0 / 57600.0,
        -71.0 / 16695.0,
        71.0 / 1920.0,
        -17253.0 / 339200.0,
        22.0 / 525.0,
        -1.0 / 40.0,
    )
    error_x = e1 * ax + e3 * ax3 + e4 * ax4 + e5 * ax5 + e6 * ax6 + e7 * bx
    error_y = e1 * ay + e3 * ay3 + e4 * ay4 + e5 * ay5 + e6 * ay6 + e7 * by
    return x, y, vx, vy, bx, by, h * (abs(error_x) + abs(error_y))
