"""One leg of a puck's way under forces: as long as the error allows, by a Runge-Kutta step of fourth order.

dv/dt = -(friction + drag v^2) along v, plus the effects' forces (`force`). The direction of friction changes fast where
the puck is slow and turns, so a leg takes a share of the time to a stop or a turn; further the step itself tells how
exact it is. The last hundredth of a millimetre to a stop is a closed form.
"""

from __future__ import annotations

import math

from puckpilot_env.kernel import inlined_kernel, kernel
from puckpilot_env.physics import compose
from puckpilot_env.physics.force import acceleration, push_and_friction
from puckpilot_env.physics.support import RESTING_LEG, resting_time
from puckpilot_env.physics.vector import size

SHARE_OF_TURN, SHARE_OF_STOP = 0.25, 0.6  # of the time to a turn or to a stop, that a leg may take
TOLERANCE = 2e-7  # m/s, of a leg's error as its stages show it, which is far above its error
SHORTEST = 1e-6  # s, of a leg that forces shorten
LAST_WAY = 1e-5  # m to a stop; by then friction and forces are constant
NEGLIGIBLE = 1e-9  # m/s; a puck so slow rests, or starts from a rest
AT_EDGE = 1e-8  # s; a leg ends so long before an edge of the law, and the next one crosses it
HESITATION = 1e-4  # s; a puck whose start the forces undo within it, since they depend on its heading, rests
TRIES = 12  # of a leg, each shorter than the one before


@kernel
def stop(puck, p, t, free_x, free_y):
    """`(duration, dx, dy)` of the way of a slow puck to its stop, under constant friction f and force g; infinite where
    it does not stop.

    With v the speed and c the cosine between v and g, d(f v + g v c)/dt = g^2 - f^2; such sums of v^2, v^2 c, v^2 c^2
    give the way along g, and across it.
    """
    gx, gy, f = push_and_friction(p, puck.turned, t, puck.x, puck.y, puck.vx, puck.vy, puck.spin)
    gx, gy = free_x * gx, free_y * gy
    v, g = size(puck.vx, puck.vy), size(gx, gy)
    if g >= f * (1.0 - 1e-9):
        return math.inf, 0.0, 0.0
    ux, uy = (gx / g, gy / g) if g > 0.0 else (puck.vx / v, puck.vy / v)
    along, across = puck.vx * ux + puck.vy * uy, puck.vy * ux - puck.vx * uy
    room = (f - g) * (f + g)
    duration = (f * v + g * along) / room
    way = (f * v * along + 0.5 * g * (v * v + along * along)) / (2.0 * room)
    aside = across * (2.0 * f * v + g * along) / (4.0 * f * f - g * g)
    return duration, way * ux - aside * uy, way * uy + aside * ux


@inlined_kernel
def step(puck, p, t, ax, ay, h, free_x, free_y):
    """`(x, y, vx, vy, bx, by, error)` after `h` [s] from the acceleration `a`, with the acceleration `b` there.

    Runge-Kutta's classical step. `error` [m/s]: by how much the last stage missed, for its share of the step.
    """
    x, y, vx, vy, half = puck.x, puck.y, puck.vx, puck.vy, 0.5 * h
    turned, spin = puck.turned, puck.spin
    spin_half, spin_end = spin, spin
    if spin != 0.0:
        spin_half = spin * math.exp(-p.spin_decay * half)
        spin_end = spin * math.exp(-p.spin_decay * h)
    vx2, vy2 = vx + half * ax, vy + half * ay
    ax2, ay2 = acceleration(p, turned, t + half, x + half * vx, y + half * vy, vx2, vy2, spin_half, free_x, free_y)
    vx3, vy3 = vx + half * ax2, vy + half * ay2
    ax3, ay3 = acceleration(p, turned, t + half, x + half * vx2, y + half * vy2, vx3, vy3, spin_half, free_x, free_y)
    vx4, vy4 = vx + h * ax3, vy + h * ay3
    ax4, ay4 = acceleration(p, turned, t + h, x + h * vx3, y + h * vy3, vx4, vy4, spin_end, free_x, free_y)
    x += h * (vx + h * (ax + ax2 + ax3) / 6.0)
    y += h * (vy + h * (ay + ay2 + ay3) / 6.0)
    vx += h * (ax + 2.0 * (ax2 + ax3) + ax4) / 6.0
    vy += h * (ay + 2.0 * (ay2 + ay3) + ay4) / 6.0
    bx, by = acceleration(p, turned, t + h, x, y, vx, vy, spin_end, free_x, free_y)
    return x, y, vx, vy, bx, by, h * (abs(bx - ax4) + abs(by - ay4) + abs(ax3 - ax2) + abs(ay3 - ay2)) / 6.0


@kernel
def _up_to_an_edge(puck, p, t, h, x, y, vx, vy):
    """How long [s] a leg may be so that it ends just before an edge of the law, if it goes to (x, y), `v` in `h`; a leg
    that begins at an edge crosses it."""
    before = size(puck.vx, puck.vy)
    x0, y0 = puck.x, puck.y
    if puck.turned != 0:
        x0, y0, x, y = p.length - x0, p.width - y0, p.length - x, p.width - y
    share = compose.edge(p, t, x0, y0, before, t + h, x, y, size(vx, vy))
    return max(share * h - AT_EDGE, 3.0 * AT_EDGE)


@kernel
def leg(puck, p, t, longest, free_x, free_y):
    """`(duration, ax, ay, x, y, vx, vy, bx, by)` of the puck's next leg from the time `t` of the episode, of at most
    `longest` [s]: the acceleration at its beginning, and place, velocity and acceleration at its end. `free` as in
    `force.acceleration`. Of the puck nothing changes but a negligible velocity, which ends.
    """
    v = size(puck.vx, puck.vy)
    if v < NEGLIGIBLE:
        puck.vx, puck.vy, v = 0.0, 0.0, 0.0
    ax, ay = acceleration(p, puck.turned, t, puck.x, puck.y, puck.vx, puck.vy, puck.spin, free_x, free_y)
    if v == 0.0 and ax == 0.0 and ay == 0.0:
        return resting_time(puck, p, t, longest), 0.0, 0.0, puck.x, puck.y, 0.0, 0.0, 0.0, 0.0
    h = longest
    forward, across = ax * puck.vx + ay * puck.vy, abs(ay * puck.vx - ax * puck.vy)  # times v
    if v > 0.0:
        if h * across > SHARE_OF_TURN * v * v:
            h = max(SHARE_OF_TURN * v * v / across, SHORTEST)
        if -h * forward > SHARE_OF_STOP * v * v:
            h = max(SHARE_OF_STOP * v * v / -forward, SHORTEST)
            if 0.5 * v * v * v < LAST_WAY * -forward:
                duration, dx, dy = stop(puck, p, t, free_x, free_y)
                if duration <= longest:
                    return duration, ax, ay, puck.x + dx, puck.y + dy, 0.0, 0.0, ax, ay
    h = min(h, compose.stride(p, v))
    edged, aimed = compose.has_edges(p), False
    x, y, vx, vy, bx, by = puck.x, puck.y, puck.vx, puck.vy, ax, ay
    for left in range(TRIES - 1, -1, -1):
        x, y, vx, vy, bx, by, error = step(puck, p, t, ax, ay, h, free_x, free_y)
        if left == 0:
            break
        if error > TOLERANCE and h > SHORTEST:  # a last stage beyond an edge is such an error too
            h = max(h * (0.7 if aimed else max(0.9 * (TOLERANCE / error) ** (1.0 / 3.0), 0.1)), SHORTEST)
            continue
        if not edged:
            break
        nearer = _up_to_an_edge(puck, p, t, h, x, y, vx, vy)
        if nearer >= h - 0.1 * AT_EDGE:
            break
        h, aimed = nearer, True
    if v == 0.0 and h <= HESITATION and bx * vx + by * vy < 0.0:
        return min(longest, RESTING_LEG), 0.0, 0.0, puck.x, puck.y, 0.0, 0.0, 0.0, 0.0
    return h, ax, ay, x, y, vx, vy, bx, by
