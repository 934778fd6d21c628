"""Walls, goal posts and goal mouths: where the puck's straight path first meets the table, and the impulse there.

The goal posts are the four points where the mouths end; a goal is the puck's centre crossing the goal line inside a
mouth (report appendix G; errata row on G.1). Directions `(ux, uy)` are unit vectors, distances are along the path.
"""

from __future__ import annotations

import math

from puckpilot_env.kernel import kernel
from puckpilot_env.physics.vector import size

# Kinds of events
NOTHING, WALL_X0, WALL_X1, WALL_Y0, WALL_Y1, POST, GOAL_X0, GOAL_X1, MIDDLE_LINE, MALLET_0, MALLET_1 = range(11)

SLIDING = 1e-9  # m/s; a puck approaching more slowly slides along a wall
GRAZE = 1e-12  # m; a puck this close to missing a post misses it: less is rounding, and would be met without end


@kernel
def opposite(kind):
    """The wall across the table; posts are as they are."""
    if kind == WALL_X0:
        return WALL_X1
    if kind == WALL_X1:
        return WALL_X0
    if kind == WALL_Y0:
        return WALL_Y1
    return WALL_Y0 if kind == WALL_Y1 else kind


@kernel
def reflect(vx, vy, nx, ny, restitution):
    """Velocity after a bounce with unit normal `n`: both components keep the share `restitution` (report eq. 10).

    A puck that only seems to approach, by rounding, slides along.
    """
    normal = vx * nx + vy * ny
    if normal >= -SLIDING:
        away = max(-normal, 0.0)
        return vx + away * nx, vy + away * ny
    return restitution * (vx - 2.0 * normal * nx), restitution * (vy - 2.0 * normal * ny)


@kernel
def distance_to_post(x, y, ux, uy, post_x, post_y, radius):
    """Distance along the path to touching a post (report G.3); infinite if it is missed or left behind."""
    dx, dy = x - post_x, y - post_y
    along = dx * ux + dy * uy
    if along >= -GRAZE:
        return math.inf
    across = dx * uy - dy * ux
    chord = radius * radius - across * across
    if chord <= GRAZE * radius:
        return math.inf
    return max(-along - math.sqrt(chord), 0.0)


@kernel
def first_boundary(x, y, ux, uy, farthest, length, width, goal_width, radius):
    """`(distance [m], kind)` of the first thing met within `farthest` [m]; kind `NOTHING` if there is none.

    `kind` is one of the constants above. The puck's centre is inside the table or inside a goal mouth.
    """
    best, kind = farthest, NOTHING
    if uy > 0.0:
        gap = max((width - radius - y) / uy, 0.0)
        if gap <= best:
            best, kind = gap, WALL_Y1
    elif uy < 0.0:
        gap = max((radius - y) / uy, 0.0)
        if gap <= best:
            best, kind = gap, WALL_Y0
    half_goal = 0.5 * goal_width
    middle = 0.5 * width
    ahead = x + ux * best
    if min(x, ahead) < radius:
        best, kind = _first_at_end(x, y, ux, uy, best, kind, radius, half_goal, middle, WALL_X0, GOAL_X0)
    if max(x, ahead) > length - radius:
        best, kind = _first_at_end(length - x, y, -ux, uy, best, kind, radius, half_goal, middle, WALL_X1, GOAL_X1)
    return best, kind


@kernel
def distance_to_middle(x, ux, length):
    """Distance along the path to crossing the middle line; infinite if it leads away from it or starts on it."""
    ahead = 0.5 * length - x
    return ahead / ux if ahead * ux > 0.0 else math.inf


@kernel
def _first_at_end(depth, y, inward, uy, best, kind, radius, half_goal, middle, wall, goal):
    """`first_boundary` at one short wall; `depth` is the distance from its line, `inward` the velocity's share along
    depth (negative = towards the wall)."""
    in_mouth = depth < radius and abs(y - middle) < half_goal
    if inward < 0.0 and not in_mouth:
        gap = max((radius - depth) / inward, 0.0)
        if gap <= best and abs(y + uy * gap - middle) >= half_goal:
            return gap, wall
    for post_y in (middle - half_goal, middle + half_goal):
        gap = distance_to_post(depth, y, inward, uy, 0.0, post_y, radius)
        if gap <= best:
            best, kind = gap, POST
    if inward < 0.0:
        gap = max(-depth / inward, 0.0)
        if gap <= best:
            best, kind = gap, goal
    return best, kind


@kernel
def nearest_post(x, y, length, width, goal_width):
    """Place of the goal post nearest to `(x, y)` [m]."""
    post_x = 0.0 if x < 0.5 * length else length
    return post_x, 0.5 * width + (0.5 * goal_width if y > 0.5 * width else -0.5 * goal_width)


@kernel
def boundary_normal(kind, x, y, length, width, goal_width):
    """Unit normal, from the table towards the puck at `(x, y)`, of a wall or post that it touches."""
    if kind == WALL_X0:
        return 1.0, 0.0
    if kind == WALL_X1:
        return -1.0, 0.0
    if kind == WALL_Y0:
        return 0.0, 1.0
    if kind == WALL_Y1:
        return 0.0, -1.0
    post_x, post_y = nearest_post(x, y, length, width, goal_width)
    dx, dy = x - post_x, y - post_y
    apart = size(dx, dy)
    return dx / apart, dy / apart


@kernel
def touched(x, y, nx, ny, slack, length, width, goal_width, radius):
    """`(kind, wx, wy)`: the wall or post within `slack` [m] of the puck whose normal `w` most opposes `n`."""
    kind, wx, wy, opposed = NOTHING, 0.0, 0.0, -1e-9
    half_goal, middle = 0.5 * goal_width, 0.5 * width
    beside_mouth = abs(y - middle) >= half_goal
    if y - radius < slack and ny < opposed:
        kind, wx, wy, opposed = WALL_Y0, 0.0, 1.0, ny
    if width - radius - y < slack and -ny < opposed:
        kind, wx, wy, opposed = WALL_Y1, 0.0, -1.0, -ny
    if beside_mouth and x - radius < slack and nx < opposed:
        kind, wx, wy, opposed = WALL_X0, 1.0, 0.0, nx
    if beside_mouth and length - radius - x < slack and -nx < opposed:
        kind, wx, wy, opposed = WALL_X1, -1.0, 0.0, -nx
    if min(x, length - x) < radius + slack and not beside_mouth:
        px, py = boundary_normal(POST, x, y, length, width, goal_width)
        post_x, post_y = nearest_post(x, y, length, width, goal_width)
        if size(x - post_x, y - post_y) - radius < slack and px * nx + py * ny < opposed:
            kind, wx, wy = POST, px, py
    return kind, wx, wy
