"""What holds a puck up against the forces: walls it leans on, and walls, posts and resting mallets it rests against.

Without this a puck that a tilt presses on something would bounce there ever lower, without end.
"""

from __future__ import annotations

import math

from puckpilot_env.kernel import inlined_kernel, kernel
from puckpilot_env.physics.contacts import bounce
from puckpilot_env.physics.contacts.contact import PINCH_SLACK
from puckpilot_env.physics.gantry.mallet import acceleration_bound, axis_velocity, modes_at, place_at
from puckpilot_env.physics.sliding.force import push_and_friction
from puckpilot_env.physics.vector import size

LEANING = 1e-9  # m; a puck this near to something touches it
BRIEFEST_HOP = 1e-3  # s; a puck that would hop off a wall for less time leans on it
RESTING_LEG = 5e-3  # s; where forces change with time, a resting puck looks again after so long
PARALLEL = 1e-6  # sine of the angle between two normals that cannot hold a puck between them


@inlined_kernel
def _freedom(gap_low, gap_high, v, a):
    """`(free, v)` along one axis: 0 where a wall holds the puck, whose velocity along it is then none."""
    hop = 0.5 * BRIEFEST_HOP * a
    if (gap_low < LEANING and a < 0.0 and abs(v) <= -hop) or (gap_high < LEANING and a > 0.0 and abs(v) <= hop):
        return 0.0, 0.0
    return 1.0, v


@kernel
def lean(puck, p, t):
    """`(free_x, free_y)`: 0 along an axis on which the forces press the puck on a wall; its velocity into it ends."""
    radius = p.puck_radius
    low_y, high_y = puck.y - radius, p.width - radius - puck.y
    low_x, high_x = puck.x - radius, p.length - radius - puck.x
    at_end = min(low_x, high_x) < LEANING and abs(puck.y - 0.5 * p.width) >= 0.5 * p.goal_width
    free_x, free_y = 1.0, 1.0
    if at_end or min(low_y, high_y) < LEANING:
        ax, ay, _ = push_and_friction(p, puck.turned, t, puck.x, puck.y, puck.vx, puck.vy, puck.spin)
        if at_end:
            free_x, puck.vx = _freedom(low_x, high_x, puck.vx, ax)
        free_y, puck.vy = _freedom(low_y, high_y, puck.vy, ay)
    return free_x, free_y


@kernel
def _axis_stands(axis, t):
    _, slow, fast, volts = modes_at(axis, t)
    return axis_velocity(axis, slow, fast) == 0.0 and acceleration_bound(axis, slow, fast, volts) == 0.0


@kernel
def stands(mallet, t):
    """Whether a mallet is at rest at `t` and stays so, as far as its plan goes."""
    return _axis_stands(mallet.x, t) and _axis_stands(mallet.y, t)


@kernel
def _off_mallet(puck, p, mallet, t):
    """`(gap, nx, ny)` to a mallet and its normal at the puck; the gap is infinite where the mallet moves."""
    x, y = place_at(mallet, t)
    dx, dy = puck.x - x, puck.y - y
    apart = size(dx, dy)
    gap = apart - p.puck_radius - p.mallet_radius
    if gap < PINCH_SLACK and stands(mallet, t):
        return gap, dx / apart, dy / apart
    return math.inf, 0.0, 0.0


@kernel
def _off_post(puck, p):
    """`(gap, nx, ny)` to the nearest goal post."""
    post_x, post_y = bounce.nearest_post(puck.x, puck.y, p.length, p.width, p.goal_width)
    dx, dy = puck.x - post_x, puck.y - post_y
    apart = size(dx, dy)
    return apart - p.puck_radius, dx / apart, dy / apart


@kernel
def unsupported(fx, fy, nx, ny):
    """What is left [m/s^2] of a force that supports of unit normals `n` take up; (0, 0) is none.

    Supports only push, so it is the distance of -f from the cone of the normals.
    """
    left = size(fx, fy)
    for i in range(len(nx)):
        if fx * nx[i] + fy * ny[i] < 0.0:
            left = min(left, abs(fy * nx[i] - fx * ny[i]))
        for j in range(i):
            sine = nx[i] * ny[j] - ny[i] * nx[j]
            if abs(sine) > PARALLEL and (fy * nx[j] - fx * ny[j]) / sine >= 0.0 >= (fy * nx[i] - fx * ny[i]) / sine:
                return 0.0
    return left


@kernel
def is_held(puck, p, mallets, clock, t):
    """Whether what a slow puck touches, and friction, hold it against the forces at `t` [s] of the plans.

    `clock` [s] is the time of the episode when the plans began. It touches one thing at least; of others, so near that
    a mallet would jam it against them, it need not.
    """
    ax, ay, friction = push_and_friction(p, puck.turned, clock + t, puck.x, puck.y, 0.0, 0.0, puck.spin)
    force = size(ax, ay)
    most = BRIEFEST_HOP * (force + friction)
    if force <= friction or puck.vx * puck.vx + puck.vy * puck.vy > most * most:  # friction holds it alone, or not yet
        return False
    x, y, radius = puck.x, puck.y, p.puck_radius
    at_end = abs(y - 0.5 * p.width) >= 0.5 * p.goal_width
    gap_x = min(x, p.length - x) - radius if at_end else math.inf
    gap_y = min(y, p.width - y) - radius
    post, post_x, post_y = _off_post(puck, p)
    first, first_x, first_y = _off_mallet(puck, p, mallets[0], max(t, 0.0))
    second, second_x, second_y = _off_mallet(puck, p, mallets[1], max(t, 0.0))
    if min(min(gap_x, gap_y), min(post, min(first, second))) >= LEANING:
        return False
    wall_x = (1.0 if x < 0.5 * p.length else -1.0) if gap_x < PINCH_SLACK else 0.0
    wall_y = (1.0 if y < 0.5 * p.width else -1.0) if gap_y < PINCH_SLACK else 0.0
    if post >= PINCH_SLACK:
        post_x, post_y = 0.0, 0.0
    nx, ny = (wall_x, 0.0, post_x, first_x, second_x), (0.0, wall_y, post_y, first_y, second_y)
    return unsupported(ax, ay, nx, ny) <= friction


@kernel
def resting_time(puck, p, t, longest):
    """How long [s] a puck at rest from the time `t` of the episode is left alone: until it looks again where forces or
    friction are others later, and so may not hold it."""
    now = push_and_friction(p, puck.turned, t, puck.x, puck.y, 0.0, 0.0, puck.spin)
    half = push_and_friction(p, puck.turned, t + 0.5 * longest, puck.x, puck.y, 0.0, 0.0, puck.spin)
    end = push_and_friction(p, puck.turned, t + longest, puck.x, puck.y, 0.0, 0.0, puck.spin)
    most_force = max(size(now[0], now[1]), max(size(half[0], half[1]), size(end[0], end[1])))
    least_friction = min(now[2], min(half[2], end[2]))
    change = abs(end[0] - now[0]) + abs(end[1] - now[1]) + abs(end[2] - now[2])
    change += abs(half[0] - now[0]) + abs(half[1] - now[1]) + abs(half[2] - now[2])
    return longest if change == 0.0 or most_force + change < least_friction else min(longest, RESTING_LEG)
