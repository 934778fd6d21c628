"""The obstacles of a puck: walls, posts, mallets, and the two goal lines, each with a gap that is negative in overlap.

Obstacles are numbered: walls 0..3 (x = 0, x = length, y = 0, y = width), posts 4..7 (x0 low y, x0 high y, xL low y,
xL high y), goal lines 8..9, mallets from 10.
"""

from __future__ import annotations

from math import sqrt

from puckpilot_env.kernel import kernel
from sim2real.study.independent_table.physics.puck import X, Y

POST, GOAL, MALLET = 4, 8, 10
NAMES = ("x0", "xL", "y0", "yW", "x0y0", "x0yW", "xLy0", "xLyW", "x0", "xL", "0", "1")
FAR = 1e3  # m, the gap to an obstacle that is out of reach


@kernel
def wall_line(law, which):
    """Place [m] of a wall along its axis at its middle, and its slope [1], against the walls' nominal directions."""
    if which == 0:
        return law.wall_offset_x0, law.wall_slope_x0
    if which == 1:
        return law.length + law.wall_offset_x1, law.wall_slope_x1
    if which == 2:
        return law.wall_offset_y0, law.wall_slope_y0
    return law.width + law.wall_offset_y1, law.wall_slope_y1


@kernel
def gap(law, which, puck, mallets):
    """Distance [m] that the puck can still move towards obstacle `which` before contact."""
    x, y = puck[X], puck[Y]
    if which < 2:  # a short wall has no surface inside the mouth
        if abs(y - 0.5 * law.width) < 0.5 * law.goal_width:
            return FAR
        place, slope = wall_line(law, which)
        beyond = (x - place - slope * (y - 0.5 * law.width)) / sqrt(1.0 + slope * slope)
        return (beyond if which == 0 else -beyond) - law.puck_radius
    if which < POST:
        place, slope = wall_line(law, which)
        beyond = (y - place - slope * (x - 0.5 * law.length)) / sqrt(1.0 + slope * slope)
        return (beyond if which == 2 else -beyond) - law.puck_radius
    if which < GOAL:
        post_x, post_y = post(law, which)
        return sqrt((x - post_x) ** 2 + (y - post_y) ** 2) - law.puck_radius
    if which < MALLET:
        return x if which == GOAL else law.length - x
    k = which - MALLET
    return sqrt((x - mallets[k, 0]) ** 2 + (y - mallets[k, 3]) ** 2) - law.puck_radius - law.mallet_radius


@kernel
def normal(law, which, puck, mallets):
    """Unit vector from the obstacle to the puck's centre at contact."""
    if which == GOAL:
        return 1.0, 0.0
    if which == GOAL + 1:
        return -1.0, 0.0
    if which < POST:
        _, slope = wall_line(law, which)
        long = sqrt(1.0 + slope * slope) * (1.0 if which % 2 == 0 else -1.0)
        return (1.0 / long, -slope / long) if which < 2 else (-slope / long, 1.0 / long)
    if which < GOAL:
        from_x, from_y = post(law, which)
    else:
        from_x, from_y = mallets[which - MALLET, 0], mallets[which - MALLET, 3]
    dx, dy = puck[X] - from_x, puck[Y] - from_y
    distance = sqrt(dx * dx + dy * dy)
    if distance == 0.0:  # coincident centres: choose any direction
        return 1.0, 0.0
    return dx / distance, dy / distance


@kernel
def post(law, which):
    """Corner point of the goal mouth, obstacle 4..7."""
    x = 0.0 if which < POST + 2 else law.length
    side = -0.5 if (which - POST) % 2 == 0 else 0.5
    return x, 0.5 * law.width + side * law.goal_width
