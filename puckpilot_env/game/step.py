"""One step of one table, the path of an action: plan -> physics -> sensing -> rules and rewards -> observation."""

from __future__ import annotations

from puckpilot_env.game import mirror, observation, random_stream, reward, rules, sensing, sight
from puckpilot_env.game.motion import play_step
from puckpilot_env.game.start import begin_episode
from puckpilot_env.kernel import inlined_kernel, kernel
from puckpilot_env.physics import compose
from puckpilot_env.physics.contacts import bounce
from puckpilot_env.physics.gantry import drive, drivetrain
from puckpilot_env.physics.gantry.brakeable import brakeable_volts
from puckpilot_env.physics.gantry.mallet import place_now
from puckpilot_env.physics.gantry.plan import plan_mallet, plan_orders
from puckpilot_env.physics.hand import is_by_hand


@kernel
def plan_both(table, p, nominal, actions, rewards):
    """Both players' plans, and what J.3 charges for them. actions: float32 (2, 4) in each player's own frame.

    Where orders are late, the mallets go on with those before, and the table keeps what is on its way. The table also
    keeps the orders of mallets that go in pieces, which are planned from where their motors are. A mallet in a hand
    begins its plan at once.
    """
    table.in_pieces = compose.in_pieces(p)
    late = compose.delay(p) > 0.0
    for k in range(2):
        mallet = table.mallets[k]
        x_f, y_f = mirror.meant(k, actions[k, 0], actions[k, 1], p, nominal)
        vx, vy = float(actions[k, 2]), float(actions[k, 3])
        x, y = place_now(mallet)
        rewards[k] = reward.movement_cost(x, y, x_f, y_f) + reward.voltage_cost(vx, vy)
        if p.action_noise > 0.0:
            dx, dy = random_stream.normal_pair(table.streams[k])
            vx *= 1.0 + p.action_noise * dx
            vy *= 1.0 + p.action_noise * dy
        area = mirror.area(k, p)
        if is_by_hand(table.puck, p, k):
            plan_mallet(mallet, x_f, y_f, vx, vy, area, p.max_voltage)
            continue
        planned = table.motors[k] if table.in_pieces else mallet
        if table.in_pieces:
            drivetrain.join(p, planned, mallet)
        if p.braking_time > 0.0:
            limit = p.max_voltage
            vx, vy = brakeable_volts(planned, x_f, y_f, vx, vy, area, limit, limit, p.braking_time)
        if table.in_pieces or late:
            drive.send(p, plan_orders(planned, x_f, y_f, vx, vy, area, p.max_voltage), table.orders[k])
        else:
            plan_mallet(mallet, x_f, y_f, vx, vy, area, p.max_voltage)
            if compose.loses(p):
                drive.weaken(mallet, p, area, p.max_voltage)


@kernel
def play_and_film(table, p, rule, frames, rewards, log, film):
    """`play_step`, and the camera frames exposed meanwhile that some decision will look at."""
    first, wanted = sensing.wanted_frames(table, p, rule.sensing, rule.period)
    shots, held = 0, 0
    frame, left = first, wanted
    while left:
        if left & 1:
            repeats = random_stream.uniform(table.stream) < p.held_frames
            shown = sensing.exposure(table, p, frame - 1 if repeats else frame) - table.time
            if p.frame_jitter > 0.0:
                shown = min(shown + p.frame_jitter * random_stream.normal_pair(table.stream)[0], rule.period)
                shown = max(shown, film[shots - 1, 0] if shots else 0.0)  # shots are in the order of their times
            film[shots, 0], film[shots, 1], film[shots, 2] = max(shown, 0.0), table.puck.x, table.puck.y
            held |= repeats << shots
            shots += 1
        frame, left = frame + 1, left >> 1
    over = play_step(table, p, rule, rule.period, rewards, log, film[:shots])
    shots, frame, left = 0, first, wanted
    while left:
        if left & 1:
            if not (held >> shots & 1 and sensing.repeat_frame(table, frames, frame)):
                sensing.take_frame(table, p, frames, frame, film[shots])
            shots += 1
        frame, left = frame + 1, left >> 1
    return over


@kernel
def play_and_look(table, p, rule, rewards, log, film):
    """`play_step` whose observations are exact, but as old as a table's loop has them."""
    if p.observation_age == 0.0:
        return play_step(table, p, rule, rule.period, rewards, log, film[:0])
    age = sight.set_times(p, rule.period, film)
    over = play_step(table, p, rule, rule.period, rewards, log, film[:2])
    sight.look_back(table, age, film)
    return over


@kernel
def _random_impulse(table, p, period):
    if random_stream.uniform(table.stream) < p.impulse_rate * period:
        x, y = random_stream.normal_pair(table.stream)
        x, y = mirror.velocity(table.puck.turned, p.impulse_speed * x, p.impulse_speed * y)
        table.puck.vx += x
        table.puck.vy += y


@inlined_kernel
def step_table(table, p, nominal, rule, frames, actions, rewards, log, film):
    """Play one step. Afterwards `table.ending` says whether and how the episode ended.

    table: a `state.TABLE` record; p: its parameters; nominal: those that players may know; rule: a `rules.RULES`
    record; frames: its camera frames; actions: float32 (2, 4), finite; rewards: float32 (2,), written; log: see
    `physics.advance`; film: (MOST_WANTED, SHOT_COLUMNS), scratch.
    """
    table.ending, lead = rules.RUNNING, table.score[0] - table.score[1]
    plan_both(table, p, nominal, actions, rewards)
    if rule.sensing == sensing.EXACT:
        scored = play_and_look(table, p, rule, rewards, log, film)
    else:
        scored = play_and_film(table, p, rule, frames, rewards, log, film)
    table.steps += 1
    table.time = table.steps * rule.period
    table.held += rule.period
    refilled = False
    if scored:
        kind = bounce.GOAL_X0 if table.puck.x < 0.5 * p.length else bounce.GOAL_X1
        rules.goal(table, p, rule, rewards, kind)
        refilled = table.ending == rules.RUNNING
    else:
        rules.look_for_clear(table, p, rule, rewards)
        if p.impulse_rate > 0.0:
            _random_impulse(table, p, rule.period)
    if table.ending == rules.RUNNING:
        refilled = rules.keep_time(table, p, rule, rewards) or refilled
    if rule.sparse_reward:
        rules.sparse_rewards(table, rule, rewards, lead)
    if refilled and rule.sensing == sensing.EXACT:
        sight.look_now(table)
    if rule.sensing != sensing.EXACT:
        if refilled:
            sensing.fill_frames(table, p, frames)
        table.newest = sensing.newest_frame(table, p, table.time)


@kernel
def begin_table(table, p, row, drawn, rule, frames):
    """Begin a new episode of a table."""
    begin_episode(table, p, row, drawn, rule.game)
    sight.look_now(table)
    if rule.sensing != sensing.EXACT:
        sensing.begin_frames(table, p, frames)
        table.newest = sensing.newest_frame(table, p, table.time)


@kernel
def observe_table(table, p, nominal, rule, frames, bounds, rows):
    """Write both players' observations; see `observation.write`."""
    observation.write(table, p, nominal, rule, frames, bounds, rows)
