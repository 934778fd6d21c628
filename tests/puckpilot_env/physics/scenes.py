"""Scenes that aim at trouble: a vector of unit numbers becomes a puck, two moving mallets, and what they are told.

The mallets' states are reachable ones: each starts at rest in its area and is on its way for a while. The puck is
placed first, on purpose against walls, corners, posts and mallets; the mallets then come for it.
"""

from __future__ import annotations

import math

from puckpilot_env.kernel import array_kernel
from puckpilot_env.physics.gantry.mallet import place_at
from tests.puckpilot_env.physics.table_driver import cut, place, plan_both, put_at_rest

UNITS = 32  # numbers that make a scene
FREE, WALL, CORNER, POST, MOUTH, MIDDLE = range(6)  # where the puck starts
KINDS = 6
FASTEST = 30.0  # m/s


@array_kernel
def edged(u, low, high):
    """A number in [low, high]; each end gets a share of its own."""
    return low + (high - low) * min(max(1.2 * u - 0.1, 0.0), 1.0)


@array_kernel
def small(u):
    """A gap [m]: exactly none, or 1e-10 ... 1e-1."""
    return 0.0 if u < 0.15 else 10.0 ** (-10.0 + 9.0 * (u - 0.15) / 0.85)


@array_kernel
def place_puck(u, kind, p):
    """Where a puck of this kind of scene is; u has 4 numbers."""
    rp, half_goal = p.puck_radius, 0.5 * p.goal_width
    x = edged(u[0], rp, p.length - rp)
    y = edged(u[1], rp, p.width - rp)
    gap = small(u[2])
    far_x, far_y = u[3] > 0.5, (4.0 * u[3]) % 2.0 > 1.0
    if kind == WALL and (8.0 * u[3]) % 2.0 > 1.0:
        y = rp + gap
    elif kind == WALL:
        x = rp + gap
        if abs(y - 0.5 * p.width) < half_goal:
            y = 0.5 * p.width - half_goal
    elif kind == CORNER:
        x, y = rp + gap, rp + small(u[0])
    elif kind == POST:
        angle = (0.5 - u[0]) * 0.5 * math.pi + 0.25 * math.pi  # from straight in front to inside the mouth
        size = rp + min(gap, half_goal - rp)  # clear of the other post
        x, y = size * math.cos(angle), 0.5 * p.width - half_goal + size * math.sin(angle)
    elif kind == MOUTH:
        x, y = edged(u[0], 0.0, rp), 0.5 * p.width + (2.0 * u[1] - 1.0) * (half_goal - rp)
    elif kind == MIDDLE:
        x = 0.5 * p.length + (u[0] - 0.5) * 0.02
    if far_x:
        x = p.length - x
    if far_y:
        y = p.width - y
    return x, y


@array_kernel
def voltages(u, v, max_voltage):
    """Requested magnitudes: often all on one axis, often the most there is, sometimes next to none."""
    total = 2.0 * max_voltage * (1.0 if v > 0.5 else 2.0 * v)
    if v < 0.03:
        total = 1e-7
    share = min(max(1.6 * u - 0.3, 0.0), 1.0)
    return total * share, total * (1.0 - share)


@array_kernel
def aim(u, mallet_x, mallet_y, x, y, area):
    """A target [m]: mostly beyond the puck as the mallet sees it; or anywhere in the area, its edges included."""
    if u[0] < 0.25:
        return edged(u[1], area[0], area[1]), edged(u[2], area[2], area[3])
    beyond = 0.5 * u[1] * u[1] + (0.0 if u[0] < 0.35 else 0.1)
    dx, dy = x - mallet_x, y - mallet_y
    size = max(math.hypot(dx, dy), 1e-9)
    return x + beyond * dx / size, y + beyond * dy / size + 0.02 * (u[2] - 0.5)


@array_kernel
def clear_until(mallets, x, y, distance):
    """The last of 401 instants of the plans up to which both mallets keep `distance` from (x, y); negative if none."""
    longest = 0.0
    for k in range(2):
        longest = max(longest, min(mallets[k].x.t2, 1.0), min(mallets[k].y.t2, 1.0))
    last = -1.0
    for i in range(401):
        t = longest * 1.05 * i / 400.0
        for k in range(2):
            mx, my = place_at(mallets[k], t)
            if math.hypot(mx - x, my - y) < distance:
                return last
        last = t
    return last


@array_kernel
def start_mallets(u, middle, x, y, mallets, distance, area, requests, max_voltage):
    """Both mallets at rest, somewhere or close to the puck, with a first request; False where one has no room."""
    inset = 1e-3  # the plans keep clear of the area's edge by less
    for k in range(2):
        w = u[7 * k : 7 * k + 7]
        if w[0] < 0.5:  # anywhere in its area
            mx, my = edged(w[1], area[k, 0], area[k, 1]), edged(w[2], area[k, 2], area[k, 3])
        else:  # near the puck, on any side of it
            angle, away = 2.0 * math.pi * w[1], distance + small(w[2])
            mx, my = x + away * math.cos(angle), y + away * math.sin(angle)
            if middle:
                mx, my = x + (-away if k == 0 else away), y + 0.02 * (w[1] - 0.5)
        mx = min(max(mx, area[k, 0] + inset), area[k, 1] - inset)
        my = min(max(my, area[k, 2] + inset), area[k, 3] - inset)
        if math.hypot(mx - x, my - y) < distance:
            return False
        put_at_rest(mallets[k].x, mx)
        put_at_rest(mallets[k].y, my)
        requests[k, 0], requests[k, 1] = aim(w[3:6], mx, my, x, y, area[k])
        requests[k, 2], requests[k, 3] = voltages(w[4], w[6], max_voltage)
    return True


@array_kernel
def build(u, p, area, table, requests):
    """Set up `table` and its last `requests` (2, 4); False where the numbers make no possible scene."""
    mallets, puck = table.mallets, table.puck
    kind = min(int(u[0] * KINDS), KINDS - 1)
    x, y = place_puck(u[1:5], kind, p)
    distance = p.puck_radius + p.mallet_radius
    if not start_mallets(u[5:19], kind == MIDDLE, x, y, mallets, distance, area, requests, p.max_voltage):
        return False
    plan_both(mallets, requests, area, p.max_voltage)
    t = clear_until(mallets, x, y, distance) * edged(u[19], 0.0, 1.0)
    if t < 0.0:
        return False
    cut(mallets, t)
    for k in range(2):
        mx, my = place(mallets[k].x), place(mallets[k].y)
        if math.hypot(mx - x, my - y) < distance - 1e-12:
            return False
        w = u[20 + 4 * k : 24 + 4 * k]
        if w[0] > 0.4:
            requests[k, 0], requests[k, 1] = aim(w[0:3], mx, my, x, y, area[k])
            requests[k, 2], requests[k, 3] = voltages(w[2], w[3], p.max_voltage)
    speed = 0.0 if u[28] < 0.1 else FASTEST * u[28] ** 3
    heading = 2.0 * math.pi * u[29]
    if u[30] < 0.2:
        heading = 0.5 * math.pi * math.floor(4.0 * u[29])
    elif u[30] < 0.5:  # at a mallet
        towards = mallets[0 if u[30] < 0.35 else 1]
        heading = math.atan2(place(towards.y) - y, place(towards.x) - x) + 0.5 * (u[29] - 0.5)
    puck.x, puck.y = x, y
    puck.vx, puck.vy = speed * math.cos(heading), speed * math.sin(heading)
    plan_both(mallets, requests, area, p.max_voltage)
    return True
