"""Where the puck would go if no mallet touched it: what players are told (report 2.4.1) and rewards ask (J.1)."""

from __future__ import annotations

import math

from puckpilot_env.kernel import kernel
from puckpilot_env.physics.contacts import bounce
from puckpilot_env.physics.sliding import glide
from puckpilot_env.physics.vector import size

MOST_BOUNCES = 12
MISSES, SAVED, SCORES = range(3)


@kernel
def expected_place(x, y, vx, vy, p, ahead):
    """`(x, y, vx, vy)` after `ahead` [s] of free motion with its bounces; at the goal line once it is in a goal.

    After MOST_BOUNCES bounces it is where it then was.
    """
    for _ in range(MOST_BOUNCES):
        v = math.sqrt(vx * vx + vy * vy)
        if v <= 0.0 or ahead <= 0.0:
            break
        ux, uy = vx / v, vy / v
        travel, slower = glide.advance(v, ahead, p.friction, p.drag)
        gap, kind = bounce.first_boundary(x, y, ux, uy, travel, p.length, p.width, p.goal_width, p.puck_radius)
        x, y = x + ux * gap, y + uy * gap
        if kind == bounce.NOTHING:
            return x, y, ux * slower, uy * slower
        used, slower = glide.time_to(v, gap, p.friction, p.drag)
        ahead -= used
        if kind == bounce.GOAL_X0 or kind == bounce.GOAL_X1:
            return x, y, 0.0, 0.0
        nx, ny = bounce.boundary_normal(kind, x, y, p.length, p.width, p.goal_width)
        vx, vy = bounce.reflect(ux * slower, uy * slower, nx, ny, p.wall_restitution)
    return x, y, vx, vy


@kernel
def projected_shot(x, y, vx, vy, mallet_x, mallet_y, goal, p):
    """What becomes of a free puck: SCORES if it enters `goal` (a bounce kind), SAVED if it would but a mallet that
    stands at `(mallet_x, mallet_y)` is in its way, MISSES otherwise."""
    saved = False
    reach = p.puck_radius + p.mallet_radius
    for _ in range(MOST_BOUNCES):
        v = math.sqrt(vx * vx + vy * vy)
        if v <= 0.0:
            return MISSES
        ux, uy = vx / v, vy / v
        stop = min(glide.stop_distance(v, p.friction, p.drag), 4.0 * p.length)
        gap, kind = bounce.first_boundary(x, y, ux, uy, stop, p.length, p.width, p.goal_width, p.puck_radius)
        along = min(max((mallet_x - x) * ux + (mallet_y - y) * uy, 0.0), gap)
        saved = saved or size(mallet_x - x - along * ux, mallet_y - y - along * uy) < reach
        x, y = x + ux * gap, y + uy * gap
        if kind == goal:
            return SAVED if saved else SCORES
        if kind == bounce.NOTHING or kind == bounce.GOAL_X0 or kind == bounce.GOAL_X1:
            return MISSES
        if kind == bounce.WALL_X0 or kind == bounce.WALL_X1:
            return MISSES
        slower = glide.time_to(v, gap, p.friction, p.drag)[1]
        nx, ny = bounce.boundary_normal(kind, x, y, p.length, p.width, p.goal_width)
        vx, vy = bounce.reflect(ux * slower, uy * slower, nx, ny, p.wall_restitution)
    return MISSES
