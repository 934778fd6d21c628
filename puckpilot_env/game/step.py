"""One step of one table, the path of an action: plan -> physics -> sensing -> rules and rewards -> observation."""

from __future__ import annotations

from puckpilot_env import random_stream
from puckpilot_env.game import mirror, observation, reward, rules, sensing
from puckpilot_env.game.start import begin_episode
from puckpilot_env.kernel import kernel
from puckpilot_env.physics import bounce, contact
from puckpilot_env.physics.advance import advance
from puckpilot_env.physics.mallet import axis_at
from puckpilot_env.physics.plan import write_plan

MOST_CROSSINGS = 200  # of the middle line in one stretch; a puck that jitters there more often is set to rest


@kernel
def _plan(table, p, actions, path, rewards):
    """Both players' plans, and what J.3 charges for them. actions: float32 (2, 4) in each player's own frame."""
    modes, gantry = table.modes, table.gantry
    for k in range(2):
        x_f, y_f = mirror.place(k, actions[k, 0], actions[k, 1], p)
        vx, vy = float(actions[k, 2]), float(actions[k, 3])
        mallet_x = modes[k, 0, 0] + modes[k, 0, 1] + modes[k, 0, 2]
        mallet_y = modes[k, 1, 0] + modes[k, 1, 1] + modes[k, 1, 2]
        rewards[k] = reward.movement_cost(mallet_x, mallet_y, x_f, y_f) + reward.voltage_cost(vx, vy)
        if p.action_noise > 0.0:
            noise_x, noise_y = random_stream.normal_pair(table, k)
            vx, vy = vx * (1.0 + p.action_noise * noise_x), vy * (1.0 + p.action_noise * noise_y)
        write_plan(path, gantry, modes, k, x_f, y_f, vx, vy, mirror.area(k, p), p.max_voltage)


@kernel
def _play(table, p, rule, path, start, end, rewards, log):
    """The puck's motion from `start` to `end` [s] of the plans with what it means; True if the point is over."""
    now = start
    for _ in range(MOST_CROSSINGS):
        kind, now, _ = advance(table.puck, p, path, table.gantry, now, end, log)
        if kind == bounce.NOTHING:
            return False
        if kind == bounce.MIDDLE_LINE:
            entered = 1 if table.puck[2] > 0.0 else 0
            mallet = contact.mallet_motion(path, table.gantry, entered, now)
            rules.crossed_middle(table, p, rule, rewards, mallet[0], mallet[1])
        else:
            return True
    table.puck[2], table.puck[3] = 0.0, 0.0
    return False


@kernel
def _play_and_film(table, p, rule, frames, path, rewards, log):
    """`_play` for a whole step, stopping where a camera frame is wanted. Returns True if the point is over."""
    period = rule.period
    now = 0.0
    if rule.sensing != sensing.EXACT:
        frame = sensing.frames_exposed(table, p)
        while True:
            at = sensing.exposure(table, p, frame) - table.time
            if at > period:
                break
            if at > now and sensing.is_looked_at(table, p, frame, rule.sensing, table.steps, period):
                if _play(table, p, rule, path, now, at, rewards, log):
                    return True
                now = at
                sensing.take_frame(table, p, frames, frame, table.puck[0], table.puck[1], path, at)
            frame += 1
    return _play(table, p, rule, path, now, period, rewards, log)


@kernel
def _settle_mallets(table, path, period):
    for k in range(2):
        for a in range(2):
            rest, slow, fast, _ = axis_at(path, table.gantry, k, a, period)
            table.modes[k, a, 0], table.modes[k, a, 1], table.modes[k, a, 2] = rest, slow, fast


@kernel
def _random_impulse(table, p, period):
    if random_stream.uniform(table, random_stream.TABLE) < p.impulse_rate * period:
        x, y = random_stream.normal_pair(table, random_stream.TABLE)
        x, y = mirror.velocity(table.turned, p.impulse_speed * x, p.impulse_speed * y)
        table.puck[2] += x
        table.puck[3] += y


@kernel
def step_table(table, p, rule, frames, actions, rewards, path, log):
    """Play one step. Afterwards `table.ending` says whether and how the episode ended.

    table: a `state.TABLE` record; p: its parameters; rule: a `rules.RULES` record; frames: its camera frames;
    actions: float32 (2, 4), finite; rewards: float32 (2,), written; path: scratch; log: see `physics.advance`.
    """
    table.ending = rules.RUNNING
    _plan(table, p, actions, path, rewards)
    scored = _play_and_film(table, p, rule, frames, path, rewards, log)
    _settle_mallets(table, path, rule.period)
    table.steps += 1
    table.time = table.steps * rule.period
    table.held += rule.period
    refilled = False
    if scored:
        kind = bounce.GOAL_X0 if table.puck[0] < 0.5 * p.length else bounce.GOAL_X1
        rules.goal(table, p, rule, rewards, kind)
        refilled = table.ending == rules.RUNNING
    else:
        rules.look_for_clear(table, p, rule, rewards)
        if p.impulse_rate > 0.0:
            _random_impulse(table, p, rule.period)
    if table.ending == rules.RUNNING:
        refilled = rules.keep_time(table, p, rule) or refilled
    if refilled and rule.sensing != sensing.EXACT:
        sensing.fill_frames(table, p, frames)


@kernel
def begin_table(table, p, row, drawn, rule, frames):
    """Begin a new episode of a table."""
    begin_episode(table, p, row, drawn, rule.game)
    if rule.sensing != sensing.EXACT:
        sensing.begin_frames(table, p, frames)


@kernel
def observe_table(table, p, rule, frames, bounds, rows):
    """Write both players' observations; see `observation.write`."""
    observation.write(table, p, rule, frames, bounds, rows)
