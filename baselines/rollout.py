"""Try an action before playing it: the puck and the own mallet under the physics, and what the outcome is worth.

The value runs from -1 (conceded) to 1 (a sure goal). The opponent is not simulated: once the puck leaves over the
middle line the shot is judged by `aim.shot_chance`.
"""

from __future__ import annotations

import math

import numpy as np

from baselines.aim import shot_chance
from baselines.geometry import crossing, reach_within
from puckpilot_env.game import mirror
from puckpilot_env.kernel import kernel
from puckpilot_env.physics import bounce, mallet
from puckpilot_env.physics.advance import EVENT_COLUMNS, advance
from puckpilot_env.physics.contact import mallet_motion
from puckpilot_env.physics.plan import write_plan

HORIZON = 0.45  # s
FAR = 1e3  # m; where the opponent's mallet is put out of the way
LATEST_THREAT = 1.5  # s after the horizon
NO_REACTION = 0.1  # weight of a shot's chance against an opponent that does not move
POSSESSION = 0.12  # worth of a puck under control, at best
LOST = 0.04  # what giving the puck away costs
LONGEST_HOLD = 5.0  # s; possession is worth nothing after that


@kernel
def park_opponent(path):
    """Put seat 1's mallet where nothing meets it."""
    for a in range(2):
        for c in range(mallet.PATH_COLUMNS):
            path[1, a, c] = 0.0
        path[1, a, mallet.REST0] = path[1, a, mallet.REST1] = path[1, a, mallet.REST2] = FAR


@kernel
def value_of(action, puck, own, opponent, held, p, gantry, modes, path, body, log, volts):
    """What playing `action` (4,) is worth. puck, opponent: motions; modes: the own mallet's; path, body, log: scratch."""
    write_plan(
        path, gantry, modes, 0, action[0], action[1], action[2], action[3], mirror.area(0, p), p.max_voltage
    )  # fmt: skip
    for c in range(4):
        body[c] = puck[c]
    now = 0.0
    while True:
        kind, now, _ = advance(body, p, path, gantry, now, HORIZON, log)
        if kind == bounce.GOAL_X0:
            return -1.0 - (HORIZON - now)
        if kind == bounce.GOAL_X1:
            return 0.0
        if kind == bounce.MIDDLE_LINE and body[2] > 0.0:
            return _value_of_shot(body, now, opponent, p, gantry, path, volts)
        if kind == bounce.NOTHING:
            return _value_of_end(body, held, p, gantry, path, volts)


@kernel
def _value_of_shot(body, now, opponent, p, gantry, path, volts):
    x, y, vx, vy = body[0], body[1], body[2], body[3]
    early = 0.3 * 0.5 * p.length / max(vx, 0.5)  # the opponent sees the strike before the puck crosses the line
    chance = shot_chance(x, y, vx, vy, min(early, now), opponent, p, gantry, volts)
    asleep = shot_chance(x, y, vx, vy, -10.0, opponent, p, gantry, volts)
    rest_x = path[0, 0, mallet.REST2]
    return chance + NO_REACTION * asleep + 0.01 * vx - LOST - 0.03 * rest_x / p.length


@kernel
def _value_of_end(body, held, p, gantry, path, volts):
    """Worth of a puck that is still about: who will have it, and whether it threatens the own goal."""
    x, y, vx, vy = body[0], body[1], body[2], body[3]
    mx, my, _, _ = mallet_motion(path, gantry, 0, HORIZON)
    reach = p.puck_radius + p.mallet_radius
    if x > 0.5 * p.length and vx >= 0.0:
        return -LOST
    t, at_y = crossing(x, y, vx, vy, p, reach, LATEST_THREAT)
    if t < math.inf:
        away = abs(at_y - 0.5 * p.width)
        in_goal = away < 0.5 * p.goal_width + p.puck_radius
        past = max(abs(at_y - my) - reach_within(gantry, 1, t - 0.05, volts), 0.0)
        behind = mx > x - 0.5 * reach and abs(my - y) < 3.0 * reach
        if in_goal and (past > 0.6 * reach or behind):
            return -0.7 - 0.2 * min(past, 1.0)
        danger = 0.1 * min(past, 1.0) * (1.0 if in_goal else 0.3)
    else:
        danger = 0.0
    if x > 0.5 * p.length:
        return -0.5 * LOST - danger
    patience = 1.0 - held / LONGEST_HOLD
    behind_x, behind_y = max(x - 2.5 * reach, p.mallet_radius), y
    off = math.hypot(mx - behind_x, my - behind_y)
    fast = math.hypot(vx, vy)
    deep = max(0.2 * p.length - x, 0.0) / p.length
    return POSSESSION * patience - 0.12 * min(off, 1.0) - 0.01 * fast - 0.2 * deep - danger
