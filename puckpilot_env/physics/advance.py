"""One table through one interval, from event to event: the nearest contact, apply it, again.

The puck's motion is `body`, a float64 row (x, y, vx, vy) [m, m/s] that is updated in place; the mallets follow their
`path`s (see `mallet`). Nothing here steps through time: between two events everything is a closed form.
"""

from __future__ import annotations

import math

from puckpilot_env.kernel import kernel
from puckpilot_env.physics import bounce, contact, glide
from puckpilot_env.physics.mallet import halt, reach

X, Y, VX, VY = range(4)
# Columns of an event log: time in the interval [s], kind (see bounce), the puck's place, and its velocity before, after
EVENT_COLUMNS = 8
MANY_EVENTS = 2000  # in one interval: a puck caught so is set to rest, and the mallets stall


@kernel
def _move(body, ux, uy, v, duration, friction, drag):
    path_length, speed = glide.advance(v, duration, friction, drag)
    body[X] += ux * path_length
    body[Y] += uy * path_length
    body[VX] = ux * speed
    body[VY] = uy * speed


@kernel
def _keep_inside(body, p):
    """Take back rounding: the puck's edge is never outside the table, except in a goal mouth."""
    radius = p.puck_radius
    body[Y] = min(max(body[Y], radius), p.width - radius)
    if abs(body[Y] - 0.5 * p.width) >= 0.5 * p.goal_width:
        body[X] = min(max(body[X], radius), p.length - radius)


@kernel
def _bounce(body, kind, p):
    nx, ny = bounce.boundary_normal(kind, body[X], body[Y], p.length, p.width, p.goal_width)
    body[VX], body[VY] = bounce.reflect(body[VX], body[VY], nx, ny, p.wall_restitution)


@kernel
def _other_obstacle(body, p, path, gantry, k, t, nx, ny):
    """`(mallet, wx, wy, ox, oy)` of what the puck also touches, most opposite `n`; mallet is -1: a wall, -2: none."""
    kind, wx, wy = bounce.touched(
        body[X], body[Y], nx, ny, contact.PINCH_SLACK, p.length, p.width, p.goal_width, p.puck_radius
    )
    other = 1 - k
    mx, my, ox, oy = contact.mallet_motion(path, gantry, other, t)
    dx, dy = body[X] - mx, body[Y] - my
    apart = math.hypot(dx, dy)
    opposed = min(wx * nx + wy * ny, 0.0) * apart
    if apart - p.puck_radius - p.mallet_radius < contact.PINCH_SLACK and dx * nx + dy * ny < opposed:
        return other, dx / apart, dy / apart, ox, oy
    return (-2 if kind == bounce.NOTHING else -1), wx, wy, 0.0, 0.0


@kernel
def _closes_on(body, vx, vy, p, path, gantry, k, t):
    """Whether a puck of velocity `v` that touches player `k`'s mallet runs into it."""
    mx, my, mvx, mvy = contact.mallet_motion(path, gantry, k, t)
    dx, dy = body[X] - mx, body[Y] - my
    touching = math.hypot(dx, dy) - p.puck_radius - p.mallet_radius < contact.PINCH_SLACK
    return touching and (vx - mvx) * dx + (vy - mvy) * dy < 0.0


@kernel
def _strike(body, p, path, gantry, k, t):
    """Apply the impulse of player `k`'s mallet at `t`, seeing to it that no puck is driven through anything."""
    mx, my, mvx, mvy = contact.mallet_motion(path, gantry, k, t)
    dx, dy = body[X] - mx, body[Y] - my
    apart = math.hypot(dx, dy)
    nx, ny = dx / apart, dy / apart
    push = contact.mallet_push(path, gantry, k, t, nx, ny)
    vx, vy = contact.strike(body[VX], body[VY], mvx, mvy, nx, ny, p.mallet_restitution, push, p.friction, p.drag)
    other, wx, wy, ox, oy = _other_obstacle(body, p, path, gantry, k, t, nx, ny)
    if other != -2 and (vx - ox) * wx + (vy - oy) * wy < 0.0:
        separation = (vx - mvx) * nx + (vy - mvy) * ny
        held, vx, vy = contact.pinch(
            body[VX], body[VY], mvx, mvy, nx, ny, ox, oy, wx, wy, separation, p.wall_restitution
        )
        third, tx, ty = bounce.touched(
            body[X], body[Y], vx, vy, contact.PINCH_SLACK, p.length, p.width, p.goal_width, p.puck_radius
        )
        jammed = third != bounce.NOTHING and (tx * wx + ty * wy) < 0.99
        if other == -1 and not jammed and _closes_on(body, vx, vy, p, path, gantry, 1 - k, t):
            other, jammed = 1 - k, True
        if held or jammed:
            halt(path, gantry, k, t)
            if other >= 0:
                halt(path, gantry, other, t)
            if not held:
                vx, vy = 0.0, 0.0
    body[VX], body[VY] = vx, vy


@kernel
def _first_strike(body, p, path, gantry, ux, uy, v, t, end, travel):
    """`(time, player)` of the first contact with a mallet in [t, end); time is infinite if there is none."""
    distance = p.puck_radius + p.mallet_radius
    first, player = math.inf, 0
    for k in range(2):
        home_x = path[k, 0, 3] + path[k, 0, 4] + path[k, 0, 5]
        home_y = path[k, 1, 3] + path[k, 1, 4] + path[k, 1, 5]
        reach_x = reach(path, gantry, k, 0, end)
        reach_y = reach(path, gantry, k, 1, end)
        if contact.stays_clear(body[X], body[Y], ux, uy, travel, home_x, home_y, reach_x, reach_y, distance):
            continue
        met = contact.first_contact(
            body[X], body[Y], ux, uy, v, p.friction, p.drag, path, gantry, k, t, min(end, first), distance
        )
        if met < first:
            first, player = met, k
    return first, player


@kernel
def advance(body, p, path, gantry, start, end, log):
    """Move the puck from `start` to `end` [s] of the current plans. `p` is a parameter record.

    Returns `(kind, time, events)`. `kind` says what it stopped at: GOAL_X0 or GOAL_X1 (the puck then rests on the goal
    line), MIDDLE_LINE (it is about to cross: call again from `time`), or NOTHING (it is `end`). `log` is a float64
    (m, EVENT_COLUMNS) array that takes the first m events; (0, EVENT_COLUMNS) to log none.
    """
    t = start
    events = 0
    while t < end:
        v = math.sqrt(body[VX] * body[VX] + body[VY] * body[VY])
        ux, uy = (body[VX] / v, body[VY] / v) if v > 0.0 else (1.0, 0.0)
        travel = glide.distance(v, end - t, p.friction, p.drag)
        gap, kind = travel, bounce.NOTHING
        if v > 0.0:  # a resting puck meets no wall, however near
            gap, kind = bounce.first_boundary(
                body[X], body[Y], ux, uy, travel, p.length, p.width, p.goal_width, p.puck_radius
            )
            middle = bounce.distance_to_middle(body[X], ux, p.length)
            if middle < gap:
                gap, kind = middle, bounce.MIDDLE_LINE
        until = end
        if kind != bounce.NOTHING:
            travel = gap
            until = min(t + glide.time_to(v, gap, p.friction, p.drag)[0], end)
        met, player = _first_strike(body, p, path, gantry, ux, uy, v, t, until, travel)
        if met < until or (met == until and kind == bounce.NOTHING):
            kind = bounce.MALLET_0 + player
            until = met
        _move(body, ux, uy, v, until - t, p.friction, p.drag)
        t = until
        if kind == bounce.NOTHING:
            break
        if kind == bounce.MIDDLE_LINE:
            body[X] = 0.5 * p.length
            return kind, t, events
        before_x, before_y = body[VX], body[VY]
        if kind == bounce.GOAL_X0 or kind == bounce.GOAL_X1:
            body[VX], body[VY] = 0.0, 0.0
        elif kind >= bounce.MALLET_0:
            _strike(body, p, path, gantry, player, t)
        else:
            _bounce(body, kind, p)
        _keep_inside(body, p)
        if events < log.shape[0]:
            log[events, 0], log[events, 1] = t, kind
            log[events, 2], log[events, 3] = body[X], body[Y]
            log[events, 4], log[events, 5] = before_x, before_y
            log[events, 6], log[events, 7] = body[VX], body[VY]
        events += 1
        if kind == bounce.GOAL_X0 or kind == bounce.GOAL_X1:
            return kind, t, events
        if events >= MANY_EVENTS:
            body[VX], body[VY] = 0.0, 0.0
            halt(path, gantry, 0, t)
            halt(path, gantry, 1, t)
            break
    _keep_inside(body, p)
    return bounce.NOTHING, end, events
