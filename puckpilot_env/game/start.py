"""How an episode, and a point in a match, begins: what is drawn, and where puck and mallets are."""

from __future__ import annotations

import math

from puckpilot_env.game import mirror, random_stream
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.gantry import drivetrain, mallet
from puckpilot_env.physics.vector import size

DEFENCE, ATTACK, MATCH = range(3)  # the games
UNIFORM, LOG_UNIFORM = range(2)  # distributions of a drawn parameter
SHORTEST_FLIGHT = 0.3  # s that a shot takes at least to the goal line: three decisions
HOME = 0.125  # of the table's length from the player's own goal line; y is the middle


@kernel
def draw_parameters(table, row, drawn):
    """Draw a table's randomized parameters. row: all parameters; drawn: (n, 4) of column, kind, low, high."""
    for i in range(drawn.shape[0]):
        u = random_stream.uniform(table.stream)
        low, high = drawn[i, 2], drawn[i, 3]
        value = low * (high / low) ** u if drawn[i, 1] == LOG_UNIFORM else low + (high - low) * u
        row[int(drawn[i, 0])] = value


@kernel
def build_gantries(table, p):
    """Draw each player's gantry around the parameters and derive its constants."""
    for k in range(2):
        for a in range(2):
            for c in range(3):
                table.gantry_scale[k, a, c] = 1.0
                if p.gantry_spread > 0.0:
                    table.gantry_scale[k, a, c] += random_stream.between(
                        table.streams[k], -p.gantry_spread, p.gantry_spread
                    )
            for gantry in (table.mallets[k], table.motors[k]):
                mallet.set_scaled(gantry.x if a == 0 else gantry.y, p, a, table.gantry_scale[k, a])


@kernel
def place_mallet(table, p, k, x, y):
    """Put player `k`'s mallet at rest at `(x, y)` [m] of its own frame."""
    x, y = mirror.place(k, x, y, p)
    for a in range(2):
        axis = table.mallets[k].x if a == 0 else table.mallets[k].y
        mallet.place_axis(axis, x if a == 0 else y, 0.0, 0.0)
        mallet.idle(axis)  # of late orders, those before are forgotten
    drivetrain.stand(table.motors[k], table.carriages[k], x, y)


@kernel
def place_puck(table, p, player, x, y, vx, vy):
    """Put the puck at `(x, y)` [m] with velocity `(vx, vy)` [m/s], all in `player`'s frame."""
    puck = table.puck
    puck.x, puck.y = mirror.place(player, x, y, p)
    puck.vx, puck.vy = mirror.velocity(player, vx, vy)
    puck.spin = 0.0
    puck.touched[0] = puck.touched[1] = 0
    table.held = 0.0


@kernel
def face_off(table, p):
    """Both at home, the puck on the middle line with a small random velocity, the same for either player."""
    for k in range(2):
        place_mallet(table, p, k, HOME * p.length, 0.5 * p.width)
    y = p.width * random_stream.between(table.stream, 0.2, 0.8)
    angle = random_stream.between(table.stream, -0.25 * math.pi, 0.25 * math.pi)
    speed = random_stream.between(table.stream, 0.3, 0.8)
    end = 1.0 if random_stream.uniform(table.stream) < 0.5 else -1.0
    place_puck(table, p, table.puck.turned, 0.5 * p.length, y, end * speed * math.cos(angle), speed * math.sin(angle))


@kernel
def serve(table, p, player):
    """Both at home, the puck at rest in front of `player`: who conceded the last goal, or whose opponent fouled."""
    for k in range(2):
        place_mallet(table, p, k, HOME * p.length, 0.5 * p.width)
    y = p.width * random_stream.between(table.streams[player], 0.25, 0.75)
    place_puck(table, p, player, 0.3 * p.length, y, 0.0, 0.0)


@kernel
def _shot(table, p, subject):
    """A shot from the other half at the subject's goal mouth and a little beside it, direct or over one side wall."""
    radius = p.puck_radius
    x = p.length * random_stream.between(table.stream, 0.55, 0.85)
    y = random_stream.between(table.stream, 2.0 * radius, p.width - 2.0 * radius)
    aim = 0.5 * p.width + 0.7 * p.goal_width * random_stream.between(table.stream, -1.0, 1.0)
    side = random_stream.uniform(table.stream)
    if side < 0.25:  # over the wall y = 0: aim at the target's mirror image
        aim = 2.0 * radius - aim
    elif side < 0.5:
        aim = 2.0 * (p.width - radius) - aim
    dx, dy = -x, aim - y
    way = size(dx, dy)
    speed = min(random_stream.between(table.stream, 1.0, 8.0), way / SHORTEST_FLIGHT)
    place_puck(table, p, subject, x, y, speed * dx / way, speed * dy / way)
    shooter = min(x + radius + p.mallet_radius + 0.05, p.length - p.mallet_radius)
    place_mallet(
        table, p, 1 - subject, p.length - shooter, p.width - min(max(y, p.mallet_radius), p.width - p.mallet_radius)
    )


@kernel
def _cleared_puck(table, p, subject):
    """A puck that the subject has just cleared: on its side, moving across the table (report J.1, case 1)."""
    x = p.length * random_stream.between(table.stream, 0.2, 0.45)
    y = p.width * random_stream.between(table.stream, 0.15, 0.85)
    across = random_stream.between(table.stream, 0.4, 1.5)
    if random_stream.uniform(table.stream) < 0.5:
        across = -across
    along = across * random_stream.between(table.stream, -1.0 / 7.0, 1.0 / 7.0)
    place_puck(table, p, subject, x, y, along, across)


@kernel
def begin_episode(table, p, row, drawn, game):
    """Begin a new episode of `game`: parameters, gantries, puck and mallets, flags, clocks. `row`: `p` as floats."""
    draw_parameters(table, row, drawn)
    build_gantries(table, p)
    table.episode += 1
    table.steps = 0
    table.time = 0.0
    for k in range(2):
        table.last_score[k] = table.score[k]
        table.score[k] = 0
        table.last_fouls[k] = table.fouls[k]
        table.fouls[k] = 0
    table.defending[0] = table.defending[1] = 1
    table.frame_phase = random_stream.uniform(table.stream)
    face_off(table, p)
    subject = table.subject
    if game == DEFENCE:
        table.defending[1 - subject] = 0
        _shot(table, p, subject)
    elif game == ATTACK:
        table.defending[subject] = 0
        _cleared_puck(table, p, subject)
