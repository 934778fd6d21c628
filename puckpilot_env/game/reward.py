"""The reward's terms (report appendix J), one function each. Speeds in m/s, places in m of the player's own frame."""

from __future__ import annotations

from puckpilot_env.game.predict import SAVED, SCORES
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.vector import size

CLEAR_FROM, CLEAR_TO = 0.175, 0.475  # of the table's length: 0.35 m and 0.95 m of 2 m
CLEAR_SPEED = 0.4  # m/s
CLEAR_STEEPNESS = 7.0  # |vy|/|vx|


@kernel
def is_clear(x, vx, vy, length):
    """J.1 case 1: the puck is on the own side near the middle line and moves across the table."""
    fast = vx * vx + vy * vy > CLEAR_SPEED * CLEAR_SPEED
    return CLEAR_FROM * length <= x <= CLEAR_TO * length and fast and abs(vy) > CLEAR_STEEPNESS * abs(vx)


@kernel
def clear_reward():
    """J.1 case 1: a successful defence."""
    return 2.0


@kernel
def conceded_reward():
    """J.1 case 2 and J.2 case 2: the puck entered the own goal."""
    return -1.0


@kernel
def scored_reward():
    """Match only, not in the report: the puck entered the other goal. It makes goals worth what they cost."""
    return 1.0


@kernel
def foul_reward():
    """Match only, not in the report: the puck was held for too long. As dear as a goal against, or a player would gain
    by clearing the puck, holding it, and clearing it again."""
    return -1.0


@kernel
def possession_lost_reward(speed, outcome):
    """J.1 case 3: the player, in defence, hit the puck over the middle line, which it crossed at `speed`."""
    if outcome == SCORES:
        return 5.0 * speed / 120.0
    if outcome == SAVED:
        return speed / 120.0
    return -0.05


@kernel
def shot_reward(speed, outcome):
    """J.2 case 1: the puck crossed the middle line at `speed` while the player attacked."""
    if outcome == SCORES:
        return speed * speed / 10.0
    if outcome == SAVED:
        return speed * speed / 50.0
    return 0.0


@kernel
def movement_cost(mallet_x, mallet_y, target_x, target_y):
    """J.3: the longer the commanded way, the dearer."""
    return -size(mallet_x - target_x, mallet_y - target_y) / 50.0


@kernel
def voltage_cost(volts_x, volts_y):
    """J.3: of the magnitudes that the player asked for."""
    return -size(volts_x, volts_y) / 1400.0
