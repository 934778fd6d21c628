"""The puck between two contacts: forces, and one small Runge-Kutta step."""

from __future__ import annotations

from math import sqrt

from puckpilot_env.kernel import kernel
from sim2real.study.independent_table import strange

X, Y, VX, VY, SPIN, SINCE = range(6)  # columns of a puck state; SINCE: seconds since its last contact


@kernel
def push(law, t, x, y, vx, vy, spin):
    """Acceleration [m/s^2] without friction and drag: tilt, warp, and forces across the velocity."""
    dx = x - 0.5 * law.length
    dy = y - 0.5 * law.width
    across = law.side_force + law.spin_side_force * spin
    ax = law.tilt_x - law.warp_xx * dx - law.warp_xy * dy - across * vy
    ay = law.tilt_y - law.warp_xy * dx - law.warp_yy * dy + across * vx
    more_x, more_y = strange.pull(law, t, x, y)
    return ax + more_x, ay + more_y


@kernel
def grip(law, t, x, y, vx, vy, since):
    """Sliding friction per unit mass [m/s^2]: constant in the baseline (Eq. 6)."""
    friction = law.friction
    if law.patch_radius > 0.0 and sqrt((x - law.patch_x) ** 2 + (y - law.patch_y) ** 2) < law.patch_radius:
        friction += law.patch_friction
    friction *= 1.0 + law.friction_drift * t
    if law.friction_anisotropy != 0.0 and (vx != 0.0 or vy != 0.0):
        square = vx * vx + vy * vy
        friction *= 1.0 + law.friction_anisotropy * (vx * vx - vy * vy) / square
    friction = strange.rub(law, t, x, y, vx, vy, since, friction)
    return friction if friction > 0.0 else 0.0


@kernel
def acceleration(law, t, x, y, vx, vy, spin, since):
    """Eq. (6) per unit mass, dv/dt = -(friction + drag v^2) along v, plus `push`; a puck rests if push <= friction."""
    ax, ay = push(law, t, x, y, vx, vy, spin)
    friction = grip(law, t, x, y, vx, vy, since)
    speed = sqrt(vx * vx + vy * vy)
    if speed > 0.0:
        uneven = sqrt(law.friction_ratio)
        along_x, along_y = friction / speed * uneven, friction / speed / uneven
        drag = law.drag * speed + law.linear_drag + law.cubic_drag * speed * speed
        return ax - (along_x + drag) * vx, ay - (along_y + drag) * vy
    pull = sqrt(ax * ax + ay * ay)
    if pull <= friction:
        return 0.0, 0.0
    return ax * (1.0 - friction / pull), ay * (1.0 - friction / pull)


@kernel
def advance_puck(law, t, puck, h, out):
    """One RK4 step of length h without contacts; a puck that friction stops within the step stays there."""
    x, y, vx, vy, spin, since = puck[X], puck[Y], puck[VX], puck[VY], puck[SPIN], puck[SINCE]
    out[SINCE] = since + h
    out[SPIN] = spin * (1.0 - law.spin_decay * h * (1.0 - 0.5 * law.spin_decay * h))
    speed = sqrt(vx * vx + vy * vy)
    friction = grip(law, t, x, y, vx, vy, since)
    if friction > 0.0 and speed <= friction * h:
        ax, ay = push(law, t, x, y, vx, vy, spin)
        if sqrt(ax * ax + ay * ay) <= friction:
            reach = 0.5 * speed / friction  # v^2 / 2f, along v
            out[X], out[Y], out[VX], out[VY] = x + reach * vx, y + reach * vy, 0.0, 0.0
            return
    half = 0.5 * h
    ax1, ay1 = acceleration(law, t, x, y, vx, vy, spin, since)
    vx2, vy2 = vx + half * ax1, vy + half * ay1
    ax2, ay2 = acceleration(law, t + half, x + half * vx, y + half * vy, vx2, vy2, spin, since + half)
    vx3, vy3 = vx + half * ax2, vy + half * ay2
    ax3, ay3 = acceleration(law, t + half, x + half * vx2, y + half * vy2, vx3, vy3, spin, since + half)
    vx4, vy4 = vx + h * ax3, vy + h * ay3
    ax4, ay4 = acceleration(law, t + h, x + h * vx3, y + h * vy3, vx4, vy4, spin, since + h)
    out[X] = x + h * (vx + 2.0 * vx2 + 2.0 * vx3 + vx4) / 6.0
    out[Y] = y + h * (vy + 2.0 * vy2 + 2.0 * vy3 + vy4) / 6.0
    out[VX] = vx + h * (ax1 + 2.0 * ax2 + 2.0 * ax3 + ax4) / 6.0
    out[VY] = vy + h * (ay1 + 2.0 * ay2 + 2.0 * ay3 + ay4) / 6.0
