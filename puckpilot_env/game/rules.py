"""What the puck's events mean: rewards, who defends, points, endings (report 2.4.3, J; errata row on J.1)."""

from __future__ import annotations

import numpy as np

from puckpilot_env.game import mirror, reward
from puckpilot_env.game.predict import SCORES, projected_shot
from puckpilot_env.game.start import ATTACK, DEFENCE, MATCH, face_off, serve
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.contacts import bounce
from puckpilot_env.physics.vector import size

# How an episode ended; the order is that of ENDING_NAMES.
RUNNING, CLEAR, CONCEDED, LOST, SHOT, MISSED, POINTS, CLOCK, STEP_LIMIT = range(9)
ENDING_NAMES = (
    "running", "clear", "conceded", "possession lost", "shot on goal", "shot missed", "points", "clock", "step limit",
)  # fmt: skip

RULES = np.dtype(
    [
        ("game", np.int64),  # start.DEFENCE, ATTACK or MATCH
        ("sensing", np.int64),  # sensing.EXACT, ESTIMATED or HISTORY
        ("shows_gantry", np.int64),  # 1: the agent sees its own gantry's coefficients
        ("period", np.float64),  # of a step [s]
        ("points", np.int64),  # to win a match
        ("match_time", np.float64),  # [s]
        ("possession_time", np.float64),  # in a match: longest time in one half before a foul [s]
        ("step_limit", np.int64),  # truncation; 0 for none
        ("sparse_reward", np.int64),  # 1: nothing but what decides the game is rewarded
    ]
)


@kernel
def end(table, ending, winner):
    """Note how and for whom the episode ended."""
    table.ending = ending
    table.winner = winner


@kernel
def crossed_middle(table, p, rules, rewards, mallet_x, mallet_y):
    """The puck just crossed the middle line; `(mallet_x, mallet_y)`: the mallet of the half that it enters [m].

    A player in defence loses possession by hitting the puck over the line (report 2.4.3). A puck that passes through
    its half untouched, off the end wall say, was never in its possession: its defence goes on.
    """
    vx, vy = table.puck.vx, table.puck.vy
    player = 0 if vx > 0.0 else 1  # whose half it leaves
    touched = table.puck.touched[player] == 1
    table.puck.touched[0] = table.puck.touched[1] = 0
    if table.defending[player] == 1 and not touched:
        return
    goal = bounce.GOAL_X1 if player == 0 else bounce.GOAL_X0
    outcome = projected_shot(table.puck.x, table.puck.y, vx, vy, mallet_x, mallet_y, goal, p)
    speed = (vx * vx + vy * vy) ** 0.5
    mine = player == table.subject
    if table.defending[player] == 1:
        rewards[player] += reward.possession_lost_reward(speed, outcome)
        if rules.game == DEFENCE and mine:
            end(table, LOST, -1)
    else:
        rewards[player] += reward.shot_reward(speed, outcome)
        table.defending[player] = 1
        if rules.game == ATTACK and mine:
            if outcome == SCORES:
                end(table, SHOT, player)
            else:
                end(table, MISSED, 1 - player)


@kernel
def goal(table, p, rules, rewards, kind):
    """The puck entered a goal. After a shot that ended a drill in the same step that no longer matters."""
    if table.ending != RUNNING:
        return
    conceder = 0 if kind == bounce.GOAL_X0 else 1
    scorer = 1 - conceder
    rewards[conceder] += reward.conceded_reward()
    table.score[scorer] += 1
    if rules.game != MATCH:
        end(table, CONCEDED, scorer)
        return
    rewards[scorer] += reward.scored_reward()
    table.defending[0] = table.defending[1] = 1
    if table.score[scorer] >= rules.points:
        end(table, POINTS, scorer)
    else:
        serve(table, p, conceder)


@kernel
def look_for_clear(table, p, rules, rewards):
    """Whether a defending player has just cleared the puck: what it touched moves as J.1 case 1 says."""
    if table.ending != RUNNING:
        return
    for k in range(2):
        if table.defending[k] == 1 and table.puck.touched[k] == 1:
            x, _ = mirror.place(k, table.puck.x, table.puck.y, p)
            if reward.is_clear(x, table.puck.vx, table.puck.vy, p.length):
                rewards[k] += reward.clear_reward()
                table.defending[k] = 0
                if rules.game == DEFENCE and k == table.subject:
                    end(table, CLEAR, k)


@kernel
def can_reach(puck, p, player):
    """Whether the player's mallet, somewhere in its area, touches the puck where that is."""
    x_low, x_high, y_low, y_high = mirror.area(player, p)
    dx = puck.x - min(max(puck.x, x_low), x_high)
    dy = puck.y - min(max(puck.y, y_low), y_high)
    return size(dx, dy) < p.puck_radius + p.mallet_radius


@kernel
def _held_too_long(table, p, rewards):
    """A foul of the player in whose half the puck stayed, whose opponent then serves. A puck out of that player's
    reach, in a corner say, or right on the middle line, is nobody's fault: it is faced off."""
    middle = 0.5 * p.length
    holder = 0 if table.puck.x < middle else 1
    table.defending[0] = table.defending[1] = 1
    if table.puck.x == middle or not can_reach(table.puck, p, holder):
        face_off(table, p)
    else:
        table.fouls[holder] += 1
        rewards[holder] += reward.foul_reward()
        serve(table, p, 1 - holder)


@kernel
def keep_time(table, p, rules, rewards):
    """Clocks: the end of a match, a puck held or stuck in one half, the step limit. True if the puck was moved."""
    moved = False
    if rules.game == MATCH:
        if table.time >= rules.match_time - 1e-9:
            lead = table.score[0] - table.score[1]
            end(table, CLOCK, 0 if lead > 0 else (1 if lead < 0 else -1))
        elif table.held >= rules.possession_time - 1e-9:
            _held_too_long(table, p, rewards)
            moved = True
    if table.ending == RUNNING and 0 < rules.step_limit <= table.steps:
        end(table, STEP_LIMIT, -1)
    return moved


@kernel
def sparse_rewards(table, rules, rewards, lead):
    """In place of all terms: in a match 1 for a goal and -1 for the conceder; in a drill 1 for who won it, and -1 for
    the other. lead: of player 0 before the step, in goals."""
    gain = 0.0
    if rules.game == MATCH:
        gain = table.score[0] - table.score[1] - lead
    elif table.ending != RUNNING and table.winner >= 0:
        gain = 1.0 - 2.0 * table.winner
    rewards[0], rewards[1] = gain, -gain
