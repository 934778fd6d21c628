"""What a puck on a curved path meets first: walls, posts, goal lines, the middle line, mallets.

A gap whose second derivative is at least -A cannot close before the smallest root of gap + rate t - A t^2/2. Advancing
to that root again and again jumps over no contact and converges quadratically (see `contact`). A is at hand: the path's
second derivative lies in the hull of its control points (`curve.most_bend`), which also says how far the path sags off
its chord, so that most of a table is dismissed at a glance. `cx`, `cy` are a leg's path in the share of its time.
"""

from __future__ import annotations

import math

from puckpilot_env.kernel import inlined_kernel, kernel
from puckpilot_env.physics.contacts import bounce
from puckpilot_env.physics.contacts.contact import MOST_ADVANCES, SLOWEST, TOUCH, time_to_parabola
from puckpilot_env.physics.gantry.mallet import (
    acceleration_bound,
    axis_at,
    axis_velocity,
    next_switch,
    place_now,
    reach,
)
from puckpilot_env.physics.sliding import curve

NEVER = 2.0  # a share of a leg's time beyond its end
SUNK = 5e-7  # m; a puck that forces press on a post sinks in no deeper between two bounces


@inlined_kernel
def _ahead(gap, rate, bend, slowest):
    """How long a gap that is no contact can be left alone: till then it has closed by TOUCH too much at most, or it
    closes no faster than `slowest`."""
    ahead = time_to_parabola(max(gap, 0.0) + TOUCH, rate, bend)
    return max(ahead, (rate + slowest) / bend) if bend > 0.0 else ahead


@kernel
def crossing(c, side, line, bend, begin, end, slowest):
    """The first share of time in [begin, end) at which side (place - line) closes, faster than `slowest`; or NEVER."""
    s = begin
    for _ in range(MOST_ADVANCES):
        gap, rate = side * (curve.place(c, s) - line), side * curve.rate(c, s)
        if gap <= TOUCH and rate < -slowest:
            return s
        s += _ahead(gap, rate, bend, slowest)
        if s >= end:
            return NEVER
    return s


@kernel
def _post(cx, cy, post_x, post_y, radius, bend, begin, end, slowest, slowest_sunk):
    """The same of touching a goal post; one that has SUNK in need only close faster than `slowest_sunk`."""
    s = begin
    for _ in range(MOST_ADVANCES):
        dx, dy = curve.place(cx, s) - post_x, curve.place(cy, s) - post_y
        apart = math.sqrt(dx * dx + dy * dy)
        vx, vy = curve.rate(cx, s), curve.rate(cy, s)
        gap, rate = apart - radius, (dx * vx + dy * vy) / apart
        least = slowest if gap > -SUNK else slowest_sunk
        if gap <= TOUCH and rate < -least:
            return s
        turned = (math.sqrt(vx * vx + vy * vy) + bend) / (0.5 * radius)  # of the normal, at most, till the leg's end
        towards = max(curve.most_bend_along(cx, cy, -dx / apart, -dy / apart), 0.0)
        push = min(bend, towards + turned * bend)
        ahead = _ahead(gap, rate, push, least)
        if gap > -SUNK:
            ahead = min(ahead, time_to_parabola(gap + SUNK + TOUCH, rate, push))
        s += ahead
        if s >= end:
            return NEVER
    return s


@kernel
def _at_end(cx, cy, x_line, side, p, bend_x, bend_y, end, slowest, slowest_at_post):
    """`(share, kind)` of what is met first before `end` at the short wall on `x_line`, inside of which is `side`."""
    radius, half_goal, middle = p.puck_radius, 0.5 * p.goal_width, 0.5 * p.width
    begin = 0.0
    if not (side * (cx[0] - x_line) < radius and abs(cy[0] - middle) < half_goal):
        begin = crossing(cx, side, x_line + side * radius, bend_x, 0.0, end, slowest)
        if begin >= end:
            return NEVER, bounce.NOTHING
        if abs(curve.place(cy, begin) - middle) >= half_goal:
            return begin, (bounce.WALL_X0 if side > 0.0 else bounce.WALL_X1)
    best, kind = end, bounce.NOTHING
    bend = math.sqrt(bend_x * bend_x + bend_y * bend_y)
    for post_y in (middle - half_goal, middle + half_goal):
        met = _post(cx, cy, x_line, post_y, radius, bend, begin, best, slowest_at_post, slowest)
        if met < best:
            best, kind = met, bounce.POST
    met = crossing(cx, side, x_line, bend_x, begin, best, 0.0)
    if met < best:
        best, kind = met, (bounce.GOAL_X0 if side > 0.0 else bounce.GOAL_X1)
    return best, kind


@kernel
def first_boundary(cx, cy, x1, y1, bend_x, bend_y, p, slowest, slowest_at_post):
    """`(share, kind)` of the first wall, post, goal line or middle line on a leg to (x1, y1); or NOTHING at its end.

    `bend_x` and `bend_y` bound the path's second derivatives; `slowest` is the least closing rate of a contact, and
    `slowest_at_post` that of one with a post.
    """
    best, kind = 1.0, bounce.NOTHING
    sag, radius = 0.125 * bend_y, p.puck_radius
    if min(cy[0], y1) - sag < radius:
        met = crossing(cy, 1.0, radius, bend_y, 0.0, best, slowest)
        if met < best:
            best, kind = met, bounce.WALL_Y0
    if max(cy[0], y1) + sag > p.width - radius:
        met = crossing(cy, -1.0, p.width - radius, bend_y, 0.0, best, slowest)
        if met < best:
            best, kind = met, bounce.WALL_Y1
    low, high = min(cx[0], x1) - 0.125 * bend_x, max(cx[0], x1) + 0.125 * bend_x
    if low < radius:
        met, what = _at_end(cx, cy, 0.0, 1.0, p, bend_x, bend_y, best, slowest, slowest_at_post)
        if met < best:
            best, kind = met, what
    if high > p.length - radius:
        met, what = _at_end(cx, cy, p.length, -1.0, p, bend_x, bend_y, best, slowest, slowest_at_post)
        if met < best:
            best, kind = met, what
    middle = 0.5 * p.length
    if low <= middle <= high:
        side = cx[0] - middle if cx[0] != middle else cx[1] if cx[1] != 0.0 else cx[2]
        if side != 0.0:
            met = crossing(cx, math.copysign(1.0, side), middle, bend_x, 0.0, best, 0.0)
            if met < best:
                best, kind = met, bounce.MIDDLE_LINE
    return best, kind


@inlined_kernel
def stays_clear_of_curve(x, y, dx, dy, room, mallet_x, mallet_y, reach_x, reach_y):
    """True where a puck that stays within `room`, less the mallet's reach, of the chord (dx, dy) meets no mallet."""
    wx, wy = mallet_x - x, mallet_y - y
    square = dx * dx + dy * dy
    along = min(max((dx * wx + dy * wy) / square, 0.0), 1.0) if square > 0.0 else 0.0
    wx, wy = wx - along * dx, wy - along * dy
    far = room + math.sqrt(reach_x * reach_x + reach_y * reach_y)
    return wx * wx + wy * wy > far * far


@kernel
def _strike(cx, cy, bend, h, mallet, start, end, distance):
    """Time in [start, end) at which a puck on a leg of `h` [s] from `start` on first meets a mallet; or infinity."""
    t, per_second = max(start, 0.0), 1.0 / h  # before the plans begin there is no contact
    push = bend * per_second * per_second
    for _ in range(MOST_ADVANCES):
        s = (t - start) * per_second
        rest_x, slow_x, fast_x, volts_x = axis_at(mallet.x, t)
        rest_y, slow_y, fast_y, volts_y = axis_at(mallet.y, t)
        dx = curve.place(cx, s) - (rest_x + slow_x + fast_x)
        dy = curve.place(cy, s) - (rest_y + slow_y + fast_y)
        apart = math.sqrt(dx * dx + dy * dy)
        vx = curve.rate(cx, s) * per_second - axis_velocity(mallet.x, slow_x, fast_x)
        vy = curve.rate(cy, s) * per_second - axis_velocity(mallet.y, slow_y, fast_y)
        gap, rate = apart - distance, (dx * vx + dy * vy) / apart
        if gap <= TOUCH and rate < -SLOWEST:
            return t
        bound_x = acceleration_bound(mallet.x, slow_x, fast_x, volts_x)
        bound_y = acceleration_bound(mallet.y, slow_y, fast_y, volts_y)
        bound = push + math.sqrt(bound_x * bound_x + bound_y * bound_y)
        ahead = t + _ahead(gap, rate, bound, SLOWEST)
        t = min(ahead, next_switch(mallet, t))
        if t >= end:
            return math.inf
    return t


@kernel
def first_strike(cx, cy, x1, y1, bend_x, bend_y, p, mallets, start, h, end):
    """`(time, player)` of the first contact with a mallet in [start, end) on a leg of `h` [s] from `start` on, whose
    path is at (x1, y1) at `end`; time is infinite if there is none."""
    distance = p.puck_radius + p.mallet_radius
    room = distance + 0.125 * (bend_x + bend_y)
    first, player = math.inf, 0
    for k in range(2):
        home_x, home_y = place_now(mallets[k])
        reach_x, reach_y = reach(mallets[k].x, end), reach(mallets[k].y, end)
        if stays_clear_of_curve(cx[0], cy[0], x1 - cx[0], y1 - cy[0], room, home_x, home_y, reach_x, reach_y):
            continue
        bend = math.sqrt(bend_x * bend_x + bend_y * bend_y)
        met = _strike(cx, cy, bend, h, mallets[k], start, min(end, first), distance)
        if met < first:
            first, player = met, k
    return first, player
