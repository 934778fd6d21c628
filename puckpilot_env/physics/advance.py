"""One table through one interval, from event to event: the nearest contact, apply it, again.

The puck is a record that is updated in place; the mallets, an array of two, follow their plans (see `mallet`).
Between two events everything is a closed form; only under the forces of effects the puck goes leg by leg (`ride`).
"""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.kernel import kernel
from puckpilot_env.physics import compose
from puckpilot_env.physics.contacts import bounce, contact
from puckpilot_env.physics.contacts.hit import hit
from puckpilot_env.physics.contacts.rebound import rebound
from puckpilot_env.physics.exposures import of_glide
from puckpilot_env.physics.gantry.mallet import halt, place_now, reach
from puckpilot_env.physics.sliding import force, glide, slide
from puckpilot_env.physics.sliding.ride import ride
from puckpilot_env.physics.vector import size

PUCK = np.dtype(
    [
        ("x", np.float64),  # m
        ("y", np.float64),
        ("vx", np.float64),  # m/s
        ("vy", np.float64),
        ("spin", np.float64),  # rad/s, counter-clockwise
        ("turned", np.int64),  # 1 where the table, and with it every effect, was turned round
        ("touched", np.int64, 2),  # of each mallet: 1 if it touched the puck since that last changed halves
    ],
    align=True,
)
# Columns of an event log: time in the interval [s], kind (see bounce), the puck's place, and its velocity before, after
EVENT_COLUMNS = 8
# More in an interval, and a puck is set to rest and mallets in its reach stall: events, and legs of a puck under forces
FEW_EVENTS, EVENTS_A_SECOND = 40, 600.0
FEW_LEGS, LEGS_A_SECOND = 30, 500.0
LONGER, BRIEF = 8.0, 2e-3  # a leg under forces is at most so many times, or so many seconds longer than, the one before


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
def _look_ahead(puck, p, mallets, t, end):
    """`(kind, time, ux, uy, v)`: what a gliding puck, of velocity `v u`, meets first from `t` on; NOTHING at `end`."""
    friction, drag = p.friction, p.drag
    v = size(puck.vx, puck.vy)
    ux, uy = (puck.vx / v, puck.vy / v) if v > 0.0 else (1.0, 0.0)
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
def _apply(puck, p, mallets, kind, clock, t, film):
    """What happens to the puck, and to what is noted of it, at an event."""
    if kind == bounce.GOAL_X0 or kind == bounce.GOAL_X1:
        puck.vx, puck.vy, puck.spin = 0.0, 0.0, 0.0
        of_glide(film, puck, 1.0, 0.0, 0.0, t, math.inf, p.friction, p.drag)
    elif kind >= bounce.MALLET_0:
        ax, ay = 0.0, 0.0
        if compose.is_forced(p):
            ax, ay = force.push(puck, p, clock + t)
        hit(puck, p, mallets, kind - bounce.MALLET_0, clock, t, ax, ay)
    else:
        nx, ny = bounce.boundary_normal(kind, puck.x, puck.y, p.length, p.width, p.goal_width)
        rebound(puck, p, clock + t, kind, nx, ny)
    _keep_inside(puck, p)


@kernel
def _give_up(puck, p, mallets, t, end, film):
    """Set a puck to rest of which too much would have to be said, and let the mallets stall that could come near it."""
    puck.vx, puck.vy = 0.0, 0.0
    of_glide(film, puck, 1.0, 0.0, 0.0, t, end, p.friction, p.drag)
    for k in range(2):
        x, y = place_now(mallets[k])
        far = p.puck_radius + p.mallet_radius + size(reach(mallets[k].x, end), reach(mallets[k].y, end))
        if size(puck.x - x, puck.y - y) <= far:
            halt(mallets[k], t)


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
    events, legs = 0, 0
    most_events, most_legs = FEW_EVENTS + EVENTS_A_SECOND * (end - start), FEW_LEGS + LEGS_A_SECOND * (end - start)
    forced, longest = compose.is_forced(p), math.inf
    while t < end:
        if forced:
            legs += 1
            kind, until = ride(puck, p, mallets, clock, t, min(end, t + longest), film)
            longest = LONGER * (until - t) + BRIEF
        else:
            kind, until, ux, uy, v = _look_ahead(puck, p, mallets, t, end)
            if film.shape[0] > 0:
                of_glide(film, puck, ux, uy, v, t, until, p.friction, p.drag)
            slide.move(puck, p, ux, uy, v, until - t, p.friction, p.drag)
        t = until
        if kind == bounce.NOTHING and (legs < most_legs or t >= end):
            continue
        if kind == bounce.NOTHING:
            _give_up(puck, p, mallets, t, end, film)
            break
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
        if events >= most_events or legs >= most_legs:
            _give_up(puck, p, mallets, t, end, film)
            break
    _keep_inside(puck, p)
    return bounce.NOTHING, end, events
