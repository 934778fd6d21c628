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
from puckpilot_env.physics import bounce
from puckpilot_env.physics.advance import advance
from puckpilot_env.physics.mallet import place_at
from puckpilot_env.physics.plan import plan_mallet

HORIZON = 0.45  # s
MOST_CROSSINGS = 20  # of the middle line
FAR = 1e3  # m; where the opponent's mallet is put out of the way
OPPONENTS = (0.2, 0.5, 1.0)  # how much of the voltage an opponent may use
LATEST_THREAT = 1.5  # s after the horizon

# What a player values. Worths are shares of a goal.
STYLE = np.dtype(
    [
        ("asleep", np.float64),  # weight of a shot's chance against an opponent that does not move
        ("speed", np.float64),  # worth of a shot's speed towards the goal, per m/s
        ("possession", np.float64),  # worth of a puck under control, at best
        ("lost", np.float64),  # what giving the puck away costs
        ("patience", np.float64),  # s; possession is worth nothing after that
        ("forward", np.float64),  # what ending a shot far from the own goal costs, per table length
        ("off", np.float64),  # what being away from the place behind the puck costs, per m
        ("run_up", np.float64),  # m between that place and the puck
        ("guard", np.float64),  # m from the goal line to where it waits
        ("early", np.float64),  # share of the way to the middle line during which the opponent sees a shot coming
    ]
)


@kernel
def park_opponent(mallet):
    """Put a mallet where nothing meets it, for good."""
    mallet.x.rest = mallet.x.rest2 = mallet.y.rest = mallet.y.rest2 = FAR
    mallet.x.halt = mallet.y.halt = math.inf


@kernel
def value_of(action, puck, opponent, held, p, style, mallets, free, log, volts):
    """What playing `action` (4,) is worth.

    puck, opponent: motions (x, y, vx, vy); held: see `Seen`; style: a record of `STYLE`; mallets: (2,) the own one
    where it is now, and the opponent's, parked; free (a puck) and log are scratch; volts: the most that anyone may use.
    """
    plan_mallet(mallets[0], action[0], action[1], action[2], action[3], mirror.area(0, p), p.max_voltage)
    free.x, free.y, free.vx, free.vy, free.spin = puck[0], puck[1], puck[2], puck[3], 0.0
    now = 0.0
    for _ in range(MOST_CROSSINGS):
        kind, now, _ = advance(free, p, mallets, 0.0, now, HORIZON, log, log[:, :3])
        if kind == bounce.GOAL_X0:
            return -1.0 - (HORIZON - now)
        if kind == bounce.GOAL_X1:
            return 0.0
        if kind == bounce.MIDDLE_LINE and free.vx > 0.0:
            return _value_of_shot(free, now, opponent, p, style, mallets[0], volts)
        if kind == bounce.NOTHING:
            break
    return _value_of_end(free, held, p, style, mallets[0], volts)


@kernel
def _value_of_shot(puck, now, opponent, p, style, mallet, volts):
    """Worth of a puck that crosses the middle line at `now` [s]."""
    x, y, vx, vy = puck.x, puck.y, puck.vx, puck.vy
    early = style.early * 0.5 * p.length / max(vx, 0.5)  # the opponent sees the strike before the puck crosses the line
    chance = 0.0
    for share in OPPONENTS:
        chance += shot_chance(x, y, vx, vy, min(early, now), opponent, p, mallet, share * volts) / len(OPPONENTS)
    asleep = shot_chance(x, y, vx, vy, -10.0, opponent, p, mallet, volts)
    rest_x = mallet.x.rest2
    return chance + style.asleep * asleep + style.speed * vx - style.lost - style.forward * rest_x / p.length


@kernel
def _value_of_end(puck, held, p, style, mallet, volts):
    """Worth of a puck that is still about: who will have it, and whether it threatens the own goal."""
    x, y, vx, vy = puck.x, puck.y, puck.vx, puck.vy
    mx, my = place_at(mallet, HORIZON)
    reach = p.puck_radius + p.mallet_radius
    if x > 0.5 * p.length and vx >= 0.0:
        return -style.lost
    t, at_y = crossing(x, y, vx, vy, p, reach, LATEST_THREAT)
    if t < math.inf:
        away = abs(at_y - 0.5 * p.width)
        in_goal = away < 0.5 * p.goal_width + p.puck_radius
        past = max(abs(at_y - my) - reach_within(mallet.y, t - 0.05, volts), 0.0)
        behind = mx > x - 0.5 * reach and abs(my - y) < 3.0 * reach
        if in_goal and (past > 0.6 * reach or behind):
            return -0.7 - 0.2 * min(past, 1.0)
        danger = 0.1 * min(past, 1.0) * (1.0 if in_goal else 0.3)
    else:
        danger = 0.0
    if x > 0.5 * p.length:
        return -0.5 * style.lost - danger
    patience = 1.0 - held / style.patience
    behind_x, behind_y = max(x - reach - style.run_up, p.mallet_radius), y
    off = math.hypot(mx - behind_x, my - behind_y)
    fast = math.hypot(vx, vy)
    deep = max(0.2 * p.length - x, 0.0) / p.length
    return style.possession * patience - style.off * min(off, 1.0) - 0.01 * fast - 0.2 * deep - danger
