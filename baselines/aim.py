"""How to send the puck somewhere: ways over the side walls, where and when to strike, who could stop it."""

from __future__ import annotations

import math

from baselines.geometry import STEP, reach_within, volts_to_pass
from puckpilot_env.game.predict import expected_place
from puckpilot_env.kernel import kernel
from puckpilot_env.physics import bounce, glide

DIRECT, OVER_RIGHT, OVER_LEFT = range(3)  # ways to the goal: straight, over the wall y = 0, over the wall y = width
MOST_LEGS = 5  # of a shot, between bounces
SAMPLES = 6  # places on each leg at which an opponent might stop it
REACTION = 0.06  # s, an opponent's: half a period of decisions
DOUBT = 0.03  # m; a shot that passes an opponent's reach by this scores with 73 %


@kernel
def direction(x, y, way, goal_y, p):
    """Unit vector from `(x, y)` to the place `goal_y` [m] on the opponent's goal line, `way` one of the constants.

    Bounces keep the angle, so the way over a wall is the straight way to the goal's mirror image.
    """
    radius = p.puck_radius
    if way == OVER_RIGHT:
        goal_y = 2.0 * radius - goal_y
    elif way == OVER_LEFT:
        goal_y = 2.0 * (p.width - radius) - goal_y
    dx, dy = p.length - x, goal_y - y
    size = math.hypot(dx, dy)
    return dx / size, dy / size


@kernel
def strike_normal(vx, vy, dx, dy, speed, p):
    """Unit normal (mallet to puck) with which a mallet of `speed` [m/s] along it sends a puck along the unit `d`."""
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
def first_strike(puck, own, p, mallet, bounds, way, goal_y, after, horizon, out):
    """The earliest strike, `after` [s] or later, that sends the puck `way` to `goal_y`; its time, infinite if none.

    puck, own: motions (x, y, vx, vy); bounds: (2, 4) of the action space. Writes the action into `out` (4,): a target
    beyond the puck, and voltages with which both axes come to the place of contact at that instant.
    """
    reach = p.puck_radius + p.mallet_radius
    x, y, vx, vy = puck[0], puck[1], puck[2], puck[3]
    t = 0.0
    while t < horizon:
        x, y, vx, vy = expected_place(x, y, vx, vy, p, STEP)
        t += STEP
        if t < after or x > 0.5 * p.length or x < reach:
            continue
        dx, dy = direction(x, y, way, goal_y, p)
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
    """Chance that a puck leaving the middle line scores against `opponent` (x, y, vx, vy), who may use `volts`.

    `since` [s]: how long before that the opponent could see it coming. The chance falls with how far the opponent's
    reach extends over the puck's way at the instant it passes. 0 for a puck that would not enter the goal.
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
            return 1.0 / (1.0 + math.exp(-min(spare, 1.0) / DOUBT))
        nx, ny = bounce.boundary_normal(kind, depth, y, p.length, p.width, p.goal_width)
        vx, vy = bounce.reflect(ux * slower, uy * slower, nx, ny, p.wall_restitution)
    return 0.0
