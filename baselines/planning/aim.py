"""Aiming: shots straight or off the side walls, where and when to strike, and the chance to score."""

from __future__ import annotations

import math

from baselines.planning.geometry import STEP, reach_within, volts_to_pass
from puckpilot_env.game.predict import expected_place
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.contacts import bounce
from puckpilot_env.physics.sliding import glide

DIRECT, BANK_RIGHT, BANK_LEFT = range(3)  # paths to the goal: straight, off the wall y = 0, off the wall y = width
MOST_LEGS = 5  # parts of a shot between bounces
SAMPLES = 6  # points on each leg at which an opponent might block it
REACTION = 0.06  # s, an opponent's reaction time: half a decision period
BLOCK_UNCERTAINTY = 0.03  # m; a shot that passes an opponent's reach by this scores with a chance of 73 %


@kernel
def direction(x, y, path, goal_y, p):
    """Unit vector from `(x, y)` to the point `goal_y` [m] on the opponent's goal line, `path` one of the constants.

    A bounce keeps the angle, so the path off a wall is the straight path to the goal's mirror image.
    """
    radius = p.puck_radius
    if path == BANK_RIGHT:
        goal_y = 2.0 * radius - goal_y
    elif path == BANK_LEFT:
        goal_y = 2.0 * (p.width - radius) - goal_y
    dx, dy = p.length - x, goal_y - y
    size = math.hypot(dx, dy)
    return dx / size, dy / size


@kernel
def strike_normal(vx, vy, dx, dy, speed, p):
    """Unit normal (mallet to puck) of a contact that sends a puck of velocity (vx, vy) along the unit vector (dx, dy).

    The mallet moves along the normal with `speed` [m/s]. Found by fixed-point iteration of the contact law.
    """
    nx, ny = dx, dy
    for _ in range(4):
        gain = (1.0 + p.mallet_restitution) * max(speed - vx * nx - vy * ny, 0.0)
        after = max((vx + gain * nx) * dx + (vy + gain * ny) * dy, 0.1)
        nx, ny = after * dx - vx, after * dy - vy
        size = math.hypot(nx, ny)
        if size < 1e-6:
            return dx, dy
        nx, ny = nx / size, ny / size
    return nx, ny


@kernel
def first_strike(puck, own, p, mallet, bounds, path, goal_y, after, horizon, out):
    """Time [s] of the earliest strike, `after` [s] or later, that sends the puck by `path` to `goal_y`; inf if none.

    `puck`, `own`: motions (x, y, vx, vy); `bounds` (2, 4): of the action space; only times before `horizon` [s] are
    tried. Writes the action into `out` (4,): a target beyond the puck, and voltages with which both axes reach the
    point of contact at that time.
    """
    reach = p.puck_radius + p.mallet_radius
    x, y, vx, vy = puck[0], puck[1], puck[2], puck[3]
    t = 0.0
    while t < horizon:
        x, y, vx, vy = expected_place(x, y, vx, vy, p, STEP)
        t += STEP
        if t < after or x > 0.5 * p.length or x < reach:
            continue
        dx, dy = direction(x, y, path, goal_y, p)
        nx, ny = strike_normal(vx, vy, dx, dy, 2.0, p)
        at_x, at_y = x - reach * nx, y - reach * ny
        if not (bounds[0, 0] <= at_x <= bounds[1, 0] and bounds[0, 1] <= at_y <= bounds[1, 1]):
            continue
        volts_x = volts_to_pass(mallet.x, at_x - own[0], own[2], t)
        volts_y = volts_to_pass(mallet.y, at_y - own[1], own[3], t)
        if volts_x > bounds[1, 2] or volts_x < 0.0 or abs(volts_y) > bounds[1, 3]:
            continue
        beyond = 0.25
        out[0] = min(at_x + beyond * nx, bounds[1, 0])
        out[1] = at_y + beyond * math.copysign(abs(ny), volts_y) if abs(ny) > 0.1 else at_y
        out[2], out[3] = volts_x, max(abs(volts_y), 0.0)
        return t
    return math.inf


@kernel
def shot_chance(x, y, vx, vy, since, opponent, p, mallet, volts):
    """Chance that a puck leaving the middle line scores against `opponent` (x, y, vx, vy), who may use `volts` [V].

    `since` [s]: how long the opponent has seen the shot coming by then. The chance is a logistic function of the
    smallest distance between the puck's path and what the opponent can reach in time. It is 0 for a puck that would
    miss the goal.
    """
    radius = p.puck_radius + p.mallet_radius
    spare, t = math.inf, since
    depth, vx, opponent_depth = p.length - x, -vx, p.length - opponent[0]  # from the opponent's goal line
    for _ in range(MOST_LEGS):
        v = math.hypot(vx, vy)
        if v < 1e-3 or vx >= 0.0:
            return 0.0
        ux, uy = vx / v, vy / v
        most = min(glide.stop_distance(v, p.friction, p.drag), 2.0 * p.length)
        gap, kind = bounce.first_boundary(depth, y, ux, uy, most, p.length, p.width, p.goal_width, p.puck_radius)
        if kind == bounce.NOTHING or kind == bounce.WALL_X0:
            return 0.0
        used, slower = glide.time_to(v, gap, p.friction, p.drag)
        for i in range(SAMPLES):
            share = (i + 1.0) / SAMPLES
            ready = t + share * used - REACTION
            past_x = abs(depth + share * gap * ux - opponent_depth) - reach_within(mallet.x, ready, volts)
            past_y = abs(y + share * gap * uy - opponent[1]) - reach_within(mallet.y, ready, volts)
            spare = min(spare, math.hypot(max(past_x, 0.0), max(past_y, 0.0)) - radius)
        depth, y, t = depth + gap * ux, y + gap * uy, t + used
        if kind == bounce.GOAL_X0:
            return 1.0 / (1.0 + math.exp(-min(spare, 1.0) / BLOCK_UNCERTAINTY))
        nx, ny = bounce.boundary_normal(kind, depth, y, p.length, p.width, p.goal_width)
        vx, vy = bounce.reflect(ux * slower, uy * slower, nx, ny, p.wall_restitution)
    return 0.0
