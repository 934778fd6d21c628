"""One table through one interval, from event to event: the nearest contact, apply it, again.

The puck is a record that is updated in place; the mallets, an array of two, follow their plans (see `mallet`).
Between two events everything is a closed form; only the forces of effects cut time into intervals (see `slide`).
"""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.kernel import kernel
from puckpilot_env.physics import bounce, compose, contact, glide, slide
from puckpilot_env.physics.hit import closes_on, hit
from puckpilot_env.physics.mallet import halt, place_now, reach
from puckpilot_env.physics.rebound import rebound
from puckpilot_env.physics.vector import size

PUCK = np.dtype(
    [
        ("x", np.float64),  # m
        ("y", np.float64),
        ("vx", np.float64),  # m/s
        ("vy", np.float64),
        ("spin", np.float64),  # rad/s, counter-clockwise
        ("turned", np.int64),  # 1 where the table, and with it every effect, was turned round
    ],
    align=True,
)
# Columns of an event log: time in the interval [s], kind (see bounce), the puck's place, and its velocity before, after
EVENT_COLUMNS = 8
MANY_EVENTS = 2000  # in one interval: a puck caught so is set to rest, and the mallets stall
LEANING = 1e-7  # m; a puck this near to a wall leans against it if the forces push it there
MOST_CUTS = 5  # of an interval of `slide`, so that it ends in an event
NEARLY_ALL, AT_ONCE = 0.99, 1e-3  # of an interval: where an event counts as being at its end, or at its beginning


@kernel
def _take_pictures(film, puck, ux, uy, v, t, until, friction, drag):
    """Note the places of a glide from `t` to `until` that `film` asks for."""
    for i in range(film.shape[0]):
        if t < film[i, 0] <= until:
            path_length = glide.distance(v, film[i, 0] - t, friction, drag)
            film[i, 1], film[i, 2] = puck.x + ux * path_length, puck.y + uy * path_length


@kernel
def _keep_inside(puck, p):
    """Take back rounding: the puck's edge is never outside the table, except in a goal mouth."""
    radius = p.puck_radius
    puck.y = min(max(puck.y, radius), p.width - radius)
    if abs(puck.y - 0.5 * p.width) >= 0.5 * p.goal_width:
        puck.x = min(max(puck.x, radius), p.length - radius)


@kernel
def _first_strike(puck, p, mallets, ux, uy, v, friction, drag, t, end, travel):
    """`(time, player)` of the first contact with a mallet in [t, end); time is infinite if there is none."""
    distance = p.puck_radius + p.mallet_radius
    first, player = math.inf, 0
    for k in range(2):
        home_x, home_y = place_now(mallets[k])
        reach_x, reach_y = reach(mallets[k].x, end), reach(mallets[k].y, end)
        if contact.stays_clear(puck.x, puck.y, ux, uy, travel, home_x, home_y, reach_x, reach_y, distance):
            continue
        met = contact.first_contact(puck.x, puck.y, ux, uy, v, friction, drag, mallets[k], t, min(end, first), distance)
        if met < first:
            first, player = met, k
    return first, player


@kernel
def _look_ahead(puck, p, mallets, vx, vy, friction, drag, t, end):
    """`(kind, time, ux, uy, v)`: what a puck of velocity `v u` from `t` on meets first; NOTHING at `end`."""
    v = math.sqrt(vx * vx + vy * vy)
    ux, uy = (vx / v, vy / v) if v > 0.0 else (1.0, 0.0)
    travel = glide.distance(v, end - t, friction, drag)
    gap, kind = travel, bounce.NOTHING
    if v > 0.0:  # a resting puck meets no wall, however near
        gap, kind = bounce.first_boundary(
            puck.x, puck.y, ux, uy, travel, p.length, p.width, p.goal_width, p.puck_radius
        )
        middle = bounce.distance_to_middle(puck.x, ux, p.length)
        if middle < gap:
            gap, kind = middle, bounce.MIDDLE_LINE
    until = end
    if kind != bounce.NOTHING:
        travel = gap
        until = min(t + glide.time_to(v, gap, friction, drag)[0], end)
    met, player = _first_strike(puck, p, mallets, ux, uy, v, friction, drag, t, until, travel)
    if met < until or (met == until and kind == bounce.NOTHING):
        kind = bounce.MALLET_0 + player
        until = met
    return kind, until, ux, uy, v


@kernel
def _not_through(puck, p, before_x, before_y, vx, vy):
    """The velocity (or force) `v` of a puck whose velocity was `before`, less what a wall or post it leans on holds."""
    for _ in range(2):  # in a corner there are two
        speed = size(vx, vy)
        if speed == 0.0:
            break
        kind, wx, wy = bounce.touched(
            puck.x, puck.y, vx / speed, vy / speed, LEANING, p.length, p.width, p.goal_width, p.puck_radius
        )
        if kind == bounce.NOTHING or before_x * wx + before_y * wy < -bounce.SLIDING:
            break
        into = vx * wx + vy * wy
        vx, vy = vx - into * wx, vy - into * wy
    return vx, vy


@kernel
def _look_ahead_forced(puck, p, mallets, clock, t, end):
    """`_look_ahead` for one interval of `slide`, which is shortened so that it ends in the event; then what it needs:
    `(friction, drag, pull, duration)`."""
    ax, ay = slide.force(puck, p, clock + t, puck.vx, puck.vy)
    ax, ay = _not_through(puck, p, puck.vx, puck.vy, ax, ay)
    pull, h = slide.plan_interval(puck, p, clock + t, ax, ay)
    h = min(h, end - t)
    cuts = 0
    while True:
        vx, vy = slide.kicked(puck, p, clock + t, puck.vx, puck.vy, pull, 0.5 * h)
        vx, vy = _not_through(puck, p, puck.vx, puck.vy, vx, vy)
        friction, drag = slide.interval_law(puck, p, clock + t, vx, vy, pull, h)
        until = end if h == end - t else t + h
        kind, until, ux, uy, v = _look_ahead(puck, p, mallets, vx, vy, friction, drag, t, until)
        soon, cuts = until - t, cuts + 1
        if kind == bounce.NOTHING or soon >= NEARLY_ALL * h or cuts > MOST_CUTS:
            break
        if soon > AT_ONCE * h:
            h = soon
        elif kind >= bounce.MALLET_0 and not closes_on(
            puck, puck.vx, puck.vy, p, mallets[kind - bounce.MALLET_0], t
        ):  # it was the kick that turned the puck round
            h *= 0.125
        else:
            break
    return kind, until, ux, uy, v, friction, drag, pull, h


@kernel
def _finish_forced(puck, p, now, pull, duration):
    """The kick at the end of an interval, at the time `now` of the episode."""
    before_x, before_y = puck.vx, puck.vy
    slide.finish(puck, p, now, pull, duration)
    puck.vx, puck.vy = _not_through(puck, p, before_x, before_y, puck.vx, puck.vy)


@kernel
def _apply(puck, p, mallets, kind, clock, t, film):
    """What happens to the puck, and to what is noted of it, at an event."""
    if kind == bounce.GOAL_X0 or kind == bounce.GOAL_X1:
        puck.vx, puck.vy, puck.spin = 0.0, 0.0, 0.0
        _take_pictures(film, puck, 1.0, 0.0, 0.0, t, math.inf, p.friction, p.drag)
    elif kind >= bounce.MALLET_0:
        ax, ay = 0.0, 0.0
        if compose.is_forced(p):
            ax, ay = slide.force(puck, p, clock + t, puck.vx, puck.vy)
        hit(puck, p, mallets, kind - bounce.MALLET_0, clock, t, ax, ay)
    else:
        nx, ny = bounce.boundary_normal(kind, puck.x, puck.y, p.length, p.width, p.goal_width)
        rebound(puck, p, clock + t, kind, nx, ny)
    _keep_inside(puck, p)


@kernel
def advance(puck, p, mallets, clock, start, end, log, film):
    """Move the puck from `start` to `end` [s] of the current plans. `p` is a parameter record.

    `clock` [s] is the time of the episode when the plans began. Returns `(kind, time, events)`. `kind` says what it
    stopped at: GOAL_X0 or GOAL_X1 (the puck then rests on the goal line), MIDDLE_LINE (it is about to cross: call again
    from `time`), or NOTHING (it is `end`). `log` is a float64 (m, EVENT_COLUMNS) array that takes the first m events;
    (0, EVENT_COLUMNS) to log none. `film` is a float64 (m, >= 3) array of times [s] and, written here where start <
    time <= end, the puck's places then [m].
    """
    t = start
    events = 0
    forced = compose.is_forced(p)
    pull, planned = 1.0, 0.0
    while t < end:
        if forced:
            kind, until, ux, uy, v, friction, drag, pull, planned = _look_ahead_forced(puck, p, mallets, clock, t, end)
        else:
            friction, drag = p.friction, p.drag
            kind, until, ux, uy, v = _look_ahead(puck, p, mallets, puck.vx, puck.vy, friction, drag, t, end)
        if film.shape[0] > 0:
            _take_pictures(film, puck, ux, uy, v, t, until, friction, drag)
        slide.move(puck, p, ux, uy, v, until - t, friction, drag)
        if forced:
            _finish_forced(puck, p, clock + until, pull, until - t - 0.5 * planned)
        t = until
        if kind == bounce.NOTHING:
            continue
        if kind == bounce.MIDDLE_LINE:
            puck.x = 0.5 * p.length
            return kind, t, events
        before_x, before_y = puck.vx, puck.vy
        _apply(puck, p, mallets, kind, clock, t, film)
        if events < log.shape[0]:
            log[events, 0], log[events, 1] = t, kind
            log[events, 2], log[events, 3] = puck.x, puck.y
            log[events, 4], log[events, 5] = before_x, before_y
            log[events, 6], log[events, 7] = puck.vx, puck.vy
        events += 1
        if kind == bounce.GOAL_X0 or kind == bounce.GOAL_X1:
            return kind, t, events
        if events >= MANY_EVENTS:
            puck.vx, puck.vy = 0.0, 0.0
            halt(mallets[0], t)
            halt(mallets[1], t)
            break
    _keep_inside(puck, p)
    return bounce.NOTHING, end, events
