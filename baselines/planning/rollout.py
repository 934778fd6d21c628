"""Rollout of an action: the puck and the own mallet are simulated, and the outcome is given a value.

The value ranges from -1 (conceded) to 1 (a sure goal). The opponent is not simulated: once the puck leaves over the
middle line the shot is judged by `aim.shot_chance`.
"""

from __future__ import annotations

import math

import numpy as np

from baselines.planning.aim import shot_chance
from baselines.planning.geometry import crossing, reach_within
from puckpilot_env.game import mirror
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.advance import advance
from puckpilot_env.physics.contacts import bounce
from puckpilot_env.physics.gantry.mallet import place_at
from puckpilot_env.physics.gantry.plan import plan_mallet

HORIZON = 0.45  # s
MOST_CROSSINGS = 20  # of the middle line
FAR = 1e3  # m; where the opponent's mallet is parked
OPPONENT_VOLTAGES = (0.2, 0.5, 1.0)  # shares of the highest voltage that an opponent may use, equally likely
LATEST_THREAT = 1.5  # s after the horizon

# Weights of the value; a goal counts 1.
VALUE_WEIGHTS = np.dtype(
    [
        ("asleep", np.float64),  # weight of a shot's chance to score against an opponent that stands still
        ("speed", np.float64),  # value of a shot's speed towards the goal, per m/s
        ("possession", np.float64),  # value of a puck under control, at most
        ("lost", np.float64),  # cost of giving the puck away
        ("patience", np.float64),  # s; after this time possession has no value
        ("forward", np.float64),  # cost of ending a shot away from the own goal, per table length
        ("off", np.float64),  # cost of the distance from the position behind the puck, per m
        ("run_up", np.float64),  # m between that position and the puck
        ("guard", np.float64),  # m from the goal line to the guard position
        ("early", np.float64),  # share of the way to the middle line during which the opponent sees a shot coming
    ]
)


@kernel
def park_opponent(mallet):
    """Put a mallet out of the way for the whole rollout."""
    mallet.x.rest = mallet.x.rest2 = mallet.y.rest = mallet.y.rest2 = FAR
    mallet.x.halt = mallet.y.halt = math.inf


@kernel
def value_of(action, puck, opponent, held, p, weights, scene, log, volts):
    """The value of playing `action` (4,).

    `puck`, `opponent`: motions (x, y, vx, vy); `held`: see `DecodedState`; `weights`: a record of VALUE_WEIGHTS;
    `scene`: its mallets are the own one at its present motion, and the opponent's, parked; its puck is scratch; `log`
    has no rows; `volts`: the highest voltage [V].
    """
    free, mallets = scene.puck, scene.mallets
    plan_mallet(mallets[0], action[0], action[1], action[2], action[3], mirror.area(0, p), p.max_voltage)
    free.x, free.y, free.vx, free.vy, free.spin = puck[0], puck[1], puck[2], puck[3], 0.0
    now = 0.0
    for _ in range(MOST_CROSSINGS):
        kind, now, _ = advance(free, p, mallets, 0.0, now, HORIZON, log, log)
        if kind == bounce.GOAL_X0:
            return -1.0 - (HORIZON - now)
        if kind == bounce.GOAL_X1:
            return 0.0
        if kind == bounce.MIDDLE_LINE and free.vx > 0.0:
            return _value_of_shot(free, now, opponent, p, weights, mallets[0], volts)
        if kind == bounce.NOTHING:
            break
    return _value_of_end(free, held, p, weights, mallets[0], volts)


@kernel
def _value_of_shot(puck, now, opponent, p, weights, mallet, volts):
    """Value of a puck that crosses the middle line at `now` [s]."""
    x, y, vx, vy = puck.x, puck.y, puck.vx, puck.vy
    warning = weights.early * 0.5 * p.length / max(vx, 0.5)  # s; the opponent sees the strike before the crossing
    chance = 0.0
    for share in OPPONENT_VOLTAGES:
        scores = shot_chance(x, y, vx, vy, min(warning, now), opponent, p, mallet, share * volts)
        chance += scores / len(OPPONENT_VOLTAGES)
    asleep = shot_chance(x, y, vx, vy, -10.0, opponent, p, mallet, volts)
    rest_x = mallet.x.rest2
    return chance + weights.asleep * asleep + weights.speed * vx - weights.lost - weights.forward * rest_x / p.length


@kernel
def _value_of_end(puck, held, p, weights, mallet, volts):
    """Value of a puck still in play at the horizon: who will have it, and whether it threatens the own goal."""
    x, y, vx, vy = puck.x, puck.y, puck.vx, puck.vy
    mx, my = place_at(mallet, HORIZON)
    reach = p.puck_radius + p.mallet_radius
    if x > 0.5 * p.length and vx >= 0.0:
        return -weights.lost
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
        return -0.5 * weights.lost - danger
    patience = 1.0 - held / weights.patience
    behind_x, behind_y = max(x - reach - weights.run_up, p.mallet_radius), y
    off = math.hypot(mx - behind_x, my - behind_y)
    fast = math.hypot(vx, vy)
    deep = max(0.2 * p.length - x, 0.0) / p.length
    return weights.possession * patience - weights.off * min(off, 1.0) - 0.01 * fast - 0.2 * deep - danger
