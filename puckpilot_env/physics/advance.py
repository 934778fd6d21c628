"""One table through one interval, from event to event: the nearest contact, apply it, again.

The puck is a record that is updated in place; the mallets, an array of two, follow their plans (see `mallet`).
Nothing here steps through time: between two events everything is a closed form.
"""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.kernel import kernel
from puckpilot_env.physics import bounce, contact, glide
from puckpilot_env.physics.mallet import halt, motion_at, place_now, push_at, reach
from puckpilot_env.physics.vector import size

PUCK = np.dtype([("x", np.float64), ("y", np.float64), ("vx", np.float64), ("vy", np.float64)], align=True)  # m, m/s
# Columns of an event log: time in the interval [s], kind (see bounce), the puck's place, and its velocity before, after
EVENT_COLUMNS = 8
MANY_EVENTS = 2000  # in one interval: a puck caught so is set to rest, and the mallets stall


@kernel
def _move(puck, ux, uy, v, duration, friction, drag):
    path_length, speed = glide.advance(v, duration, friction, drag)
    puck.x += ux * path_length
    puck.y += uy * path_length
    puck.vx = ux * speed
    puck.vy = uy * speed


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
def _bounce(puck, kind, p):
    nx, ny = bounce.boundary_normal(kind, puck.x, puck.y, p.length, p.width, p.goal_width)
    puck.vx, puck.vy = bounce.reflect(puck.vx, puck.vy, nx, ny, p.wall_restitution)


@kernel
def _other_obstacle(puck, p, mallets, k, t, nx, ny):
    """`(mallet, wx, wy, ox, oy)` of what the puck also touches, most opposite `n`; mallet is -1: a wall, -2: none."""
    kind, wx, wy = bounce.touched(
        puck.x, puck.y, nx, ny, contact.PINCH_SLACK, p.length, p.width, p.goal_width, p.puck_radius
    )
    other = 1 - k
    mx, my, ox, oy = motion_at(mallets[other], t)
    dx, dy = puck.x - mx, puck.y - my
    apart = size(dx, dy)
    opposed = min(wx * nx + wy * ny, 0.0) * apart
    if apart - p.puck_radius - p.mallet_radius < contact.PINCH_SLACK and dx * nx + dy * ny < opposed:
        return other, dx / apart, dy / apart, ox, oy
    return (-2 if kind == bounce.NOTHING else -1), wx, wy, 0.0, 0.0


@kernel
def _closes_on(puck, vx, vy, p, mallet, t):
    """Whether a puck of velocity `v` that touches this mallet runs into it."""
    mx, my, mvx, mvy = motion_at(mallet, t)
    dx, dy = puck.x - mx, puck.y - my
    touching = size(dx, dy) - p.puck_radius - p.mallet_radius < contact.PINCH_SLACK
    return touching and (vx - mvx) * dx + (vy - mvy) * dy < 0.0


@kernel
def _strike(puck, p, mallets, k, t):
    """Apply the impulse of player `k`'s mallet at `t`, seeing to it that no puck is driven through anything."""
    mx, my, mvx, mvy = motion_at(mallets[k], t)
    dx, dy = puck.x - mx, puck.y - my
    apart = size(dx, dy)
    nx, ny = dx / apart, dy / apart
    push = push_at(mallets[k], t, nx, ny)
    vx, vy = contact.strike(puck.vx, puck.vy, mvx, mvy, nx, ny, p.mallet_restitution, push, p.friction, p.drag)
    other, wx, wy, ox, oy = _other_obstacle(puck, p, mallets, k, t, nx, ny)
    if other != -2 and (vx - ox) * wx + (vy - oy) * wy < 0.0:
        separation = (vx - mvx) * nx + (vy - mvy) * ny
        held, vx, vy = contact.pinch(puck.vx, puck.vy, mvx, mvy, nx, ny, ox, oy, wx, wy, separation, p.wall_restitution)
        third, tx, ty = bounce.touched(
            puck.x, puck.y, vx, vy, contact.PINCH_SLACK, p.length, p.width, p.goal_width, p.puck_radius
        )
        jammed = third != bounce.NOTHING and (tx * wx + ty * wy) < 0.99
        if other == -1 and not jammed and _closes_on(puck, vx, vy, p, mallets[1 - k], t):
            other, jammed = 1 - k, True
        if held or jammed:
            halt(mallets[k], t)
            if other >= 0:
                halt(mallets[other], t)
            if not held:
                vx, vy = 0.0, 0.0
    elif vx * vx + vy * vy > contact.SQUEEZED_SPEED * contact.SQUEEZED_SPEED:
        halt(mallets[0], t)
        halt(mallets[1], t)
        vx, vy = 0.0, 0.0
    puck.vx, puck.vy = vx, vy


@kernel
def _first_strike(puck, p, mallets, ux, uy, v, t, end, travel):
    """`(time, player)` of the first contact with a mallet in [t, end); time is infinite if there is none."""
    distance = p.puck_radius + p.mallet_radius
    first, player = math.inf, 0
    for k in range(2):
        home_x, home_y = place_now(mallets[k])
        reach_x, reach_y = reach(mallets[k].x, end), reach(mallets[k].y, end)
        if contact.stays_clear(puck.x, puck.y, ux, uy, travel, home_x, home_y, reach_x, reach_y, distance):
            continue
        met = contact.first_contact(
            puck.x, puck.y, ux, uy, v, p.friction, p.drag, mallets[k], t, min(end, first), distance
        )
        if met < first:
            first, player = met, k
    return first, player


@kernel
def advance(puck, p, mallets, start, end, log, film):
    """Move the puck from `start` to `end` [s] of the current plans. `p` is a parameter record.

    Returns `(kind, time, events)`. `kind` says what it stopped at: GOAL_X0 or GOAL_X1 (the puck then rests on the goal
    line), MIDDLE_LINE (it is about to cross: call again from `time`), or NOTHING (it is `end`). `log` is a float64
    (m, EVENT_COLUMNS) array that takes the first m events; (0, EVENT_COLUMNS) to log none. `film` is a float64
    (m, 3) array of times [s] and, written here where start < time <= end, the puck's places then [m].
    """
    t = start
    events = 0
    while t < end:
        v = math.sqrt(puck.vx * puck.vx + puck.vy * puck.vy)
        ux, uy = (puck.vx / v, puck.vy / v) if v > 0.0 else (1.0, 0.0)
        travel = glide.distance(v, end - t, p.friction, p.drag)
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
            until = min(t + glide.time_to(v, gap, p.friction, p.drag)[0], end)
        met, player = _first_strike(puck, p, mallets, ux, uy, v, t, until, travel)
        if met < until or (met == until and kind == bounce.NOTHING):
            kind = bounce.MALLET_0 + player
            until = met
        if film.shape[0] > 0:
            _take_pictures(film, puck, ux, uy, v, t, until, p.friction, p.drag)
        _move(puck, ux, uy, v, until - t, p.friction, p.drag)
        t = until
        if kind == bounce.NOTHING:
            break
        if kind == bounce.MIDDLE_LINE:
            puck.x = 0.5 * p.length
            return kind, t, events
        before_x, before_y = puck.vx, puck.vy
        if kind == bounce.GOAL_X0 or kind == bounce.GOAL_X1:
            puck.vx, puck.vy = 0.0, 0.0
            _take_pictures(film, puck, 1.0, 0.0, 0.0, t, math.inf, p.friction, p.drag)
        elif kind >= bounce.MALLET_0:
            _strike(puck, p, mallets, player, t)
        else:
            _bounce(puck, kind, p)
        _keep_inside(puck, p)
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
