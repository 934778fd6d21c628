"""One leg of a puck's way under forces: as long as the error allows, by a Runge-Kutta step of fifth order.

dv/dt = -(friction + drag v^2) along v, plus the effects' forces (`force`). The direction of friction changes fast where
the puck is slow and turns, so a leg takes a share of the time to a stop or a turn; further the step itself tells how
exact it is. The last hundredth of a millimetre to a stop is a closed form.
"""

from __future__ import annotations

import math

from puckpilot_env.kernel import kernel
from puckpilot_env.physics import compose
from puckpilot_env.physics.sliding.force import acceleration, push_and_friction
from puckpilot_env.physics.sliding.runge_kutta import step
from puckpilot_env.physics.sliding.support import resting_time
from puckpilot_env.physics.vector import size

SHARE_OF_TURN, SHARE_OF_STOP = 0.25, 0.6  # of the time to a turn or to a stop, that a leg may take
TOLERANCE = 2e-8  # m/s, of a leg's error as its stages show it, which is far above its error
SHORTEST = 1e-6  # s, of a leg that forces shorten
LAST_WAY = 1e-5  # m to a stop; by then friction and forces are constant
NEGLIGIBLE = 1e-9  # m/s; a puck so slow rests, or starts from a rest
CREEP = 1e-3  # m/s; friction turns a slower puck into the forces' direction faster than any step could follow
ALIGNED = 1e-3  # rad; by which a puck that creeps may turn in a leg
AT_EDGE = 1e-8  # s; a leg ends so long before an edge of the law, and the next one crosses it
TURNING = 1e-8  # m; of the way that a puck takes to fall in line with a force
HEADINGS = 12  # that a resting puck tries, each halfway to where the force there points
TRIES = 12  # of a leg, each shorter than the one before


@kernel
def stop(puck, p, t, free_x, free_y):
    """`(duration, dx, dy)` of the way of a slow puck to its stop, under constant friction f and force g; infinite where
    it does not stop. If g is the stronger it does for a moment, where it is right against its velocity.

    With v the speed and c the cosine between v and g, d(f v + g v c)/dt = g^2 - f^2; such sums of v^2, v^2 c, v^2 c^2
    give the way along g, and across it.
    """
    gx, gy, f = push_and_friction(p, puck.turned, t, puck.x, puck.y, puck.vx, puck.vy, puck.spin)
    gx, gy = free_x * gx, free_y * gy
    v, g = size(puck.vx, puck.vy), size(gx, gy)
    ux, uy = (gx / g, gy / g) if g > 0.0 else (puck.vx / v, puck.vy / v)
    along, across = puck.vx * ux + puck.vy * uy, puck.vy * ux - puck.vx * uy
    if g >= f * (1.0 - 1e-9):
        if along > 0.0 or abs(across) > ALIGNED * v:
            return math.inf, 0.0, 0.0
        duration = v / (f + g)
        return duration, 0.5 * duration * puck.vx, 0.5 * duration * puck.vy
    room = (f - g) * (f + g)
    duration = (f * v + g * along) / room
    way = (f * v * along + 0.5 * g * (v * v + along * along)) / (2.0 * room)
    aside = across * (2.0 * f * v + g * along) / (4.0 * f * f - g * g)
    return duration, way * ux - aside * uy, way * uy + aside * ux


@kernel
def _creep(puck, p, t, ax, ay, h, free_x, free_y):
    """`runge_kutta.step` of a slow puck that the forces draw along: it keeps its acceleration `a`, as far as that at
    the end agrees."""
    vx, vy = puck.vx + h * ax, puck.vy + h * ay
    x, y = puck.x + 0.5 * h * (puck.vx + vx), puck.y + 0.5 * h * (puck.vy + vy)
    spin = puck.spin * math.exp(-p.spin_decay * h)
    bx, by = acceleration(p, puck.turned, t + h, x, y, vx, vy, spin, free_x, free_y)
    return x, y, vx, vy, bx, by, 0.5 * h * (abs(bx - ax) + abs(by - ay))


@kernel
def _up_to_an_edge(puck, p, t, h, x, y, vx, vy):
    """How long [s] a leg may be so that it ends just before an edge of the law, if it goes to (x, y), `v` in `h`; a leg
    that begins at an edge crosses it."""
    before, after = size(puck.vx, puck.vy), size(vx, vy)
    x0, y0 = puck.x, puck.y
    if puck.turned != 0:
        x0, y0, x, y = p.length - x0, p.width - y0, p.length - x, p.width - y
    share = compose.edge(p, t, x0, y0, before, t + h, x, y, after)
    return max(share * h - AT_EDGE, 3.0 * AT_EDGE)


@kernel
def _start(puck, p, t, ax, ay, free_x, free_y):
    """`(ax, ay)` with which a resting puck that accelerates with `a` begins to move, along the negligible velocity that
    it is given; none, and (0, 0), if the forces, which may depend on its heading, let it go nowhere."""
    a = size(ax, ay)
    ux, uy = ax / a, ay / a
    for _ in range(HEADINGS):
        puck.vx, puck.vy = NEGLIGIBLE * ux, NEGLIGIBLE * uy
        bx, by = acceleration(p, puck.turned, t, puck.x, puck.y, puck.vx, puck.vy, puck.spin, free_x, free_y)
        along = bx * ux + by * uy
        if along > 0.0 and abs(by * ux - bx * uy) <= ALIGNED * along:
            return along * ux, along * uy
        gx, gy, _ = push_and_friction(p, puck.turned, t, puck.x, puck.y, puck.vx, puck.vy, puck.spin)
        gx, gy = free_x * gx, free_y * gy
        g = size(gx, gy)
        if g == 0.0:
            break
        ux, uy = ux + gx / g, uy + gy / g
        both = size(ux, uy)
        if both < ALIGNED:
            break
        ux, uy = ux / both, uy / both
    puck.vx, puck.vy = 0.0, 0.0
    return 0.0, 0.0


@kernel
def _fall_in_line(puck, p, t, free_x, free_y):
    """Give a puck so slow that friction turns it into the direction of a stronger force, which it goes along with, at
    once and within TURNING, the speed that it comes to: friction v + force v cos(angle) grows evenly (see `stop`)."""
    gx, gy, f = push_and_friction(p, puck.turned, t, puck.x, puck.y, puck.vx, puck.vy, puck.spin)
    gx, gy = free_x * gx, free_y * gy
    v, g = size(puck.vx, puck.vy), size(gx, gy)
    down = puck.vx * gx + puck.vy * gy
    if g > f and down > 0.0 and v * v < TURNING * (2.0 * f - g):  # with less friction it is long in line
        along = (f * v + down) / (f + g)
        puck.vx, puck.vy = along * gx / g, along * gy / g


@kernel
def leg(puck, p, t, longest, free_x, free_y):
    """`(duration, ax, ay, x, y, vx, vy, bx, by)` of the puck's next leg from the time `t` of the episode, of at most
    `longest` [s]: the acceleration at its beginning, and place, velocity and acceleration at its end. `free` as in
    `force.acceleration`. Of the puck nothing changes but the velocity of one that creeps: a negligible one ends or
    begins, others fall in line.
    """
    v = size(puck.vx, puck.vy)
    if v < NEGLIGIBLE:
        puck.vx, puck.vy, v = 0.0, 0.0, 0.0
    elif v < CREEP:
        _fall_in_line(puck, p, t, free_x, free_y)
        v = size(puck.vx, puck.vy)
    ax, ay = acceleration(p, puck.turned, t, puck.x, puck.y, puck.vx, puck.vy, puck.spin, free_x, free_y)
    forward, across = ax * puck.vx + ay * puck.vy, abs(ay * puck.vx - ax * puck.vy)  # times v
    if v > 0.0 and SHORTEST * across > SHARE_OF_TURN * v * v:  # it turns so fast that it may as well start anew
        puck.vx, puck.vy, v = 0.0, 0.0, 0.0
        ax, ay = acceleration(p, puck.turned, t, puck.x, puck.y, 0.0, 0.0, puck.spin, free_x, free_y)
    if v == 0.0:
        if ax != 0.0 or ay != 0.0:
            ax, ay = _start(puck, p, t, ax, ay, free_x, free_y)
        if ax == 0.0 and ay == 0.0:
            return resting_time(puck, p, t, longest), 0.0, 0.0, puck.x, puck.y, 0.0, 0.0, 0.0, 0.0
        v, forward, across = NEGLIGIBLE, NEGLIGIBLE * size(ax, ay), 0.0
    h = longest
    if h * across > SHARE_OF_TURN * v * v:
        h = SHARE_OF_TURN * v * v / across
    if -h * forward > SHARE_OF_STOP * v * v:
        h = max(SHARE_OF_STOP * v * v / -forward, SHORTEST)
        if 0.5 * v * v * v < LAST_WAY * -forward:
            duration, dx, dy = stop(puck, p, t, free_x, free_y)
            if duration <= longest:
                return duration, ax, ay, puck.x + dx, puck.y + dy, 0.0, 0.0, ax, ay
    h = min(h, compose.stride(p, v))
    edged, aimed = compose.has_edges(p), False
    creeps = v < CREEP and forward >= 0.0 and h * across <= ALIGNED * v * v
    order = 0.5 if creeps else 0.2
    x, y, vx, vy, bx, by = puck.x, puck.y, puck.vx, puck.vy, ax, ay
    for left in range(TRIES - 1, -1, -1):
        if creeps:
            x, y, vx, vy, bx, by, error = _creep(puck, p, t, ax, ay, h, free_x, free_y)
        else:
            x, y, vx, vy, bx, by, error = step(puck, p, t, ax, ay, h, free_x, free_y)
        if left == 0:
            break
        nearer = _up_to_an_edge(puck, p, t, h, x, y, vx, vy) if edged else h
        if nearer < h - 0.1 * AT_EDGE:
            h, aimed = nearer, True
        elif error > TOLERANCE and h > SHORTEST:  # a last stage beyond an edge is such an error too
            h = max(h * (0.7 if aimed else max(0.9 * (TOLERANCE / error) ** order, 0.1)), SHORTEST)
        else:
            break
    return h, ax, ay, x, y, vx, vy, bx, by
