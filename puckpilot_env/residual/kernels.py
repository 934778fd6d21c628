"""What a network of residuals sees of tables, and its corrections put onto them."""

from __future__ import annotations

from puckpilot_env.game import mirror, sight
from puckpilot_env.game.observation import FASTEST_PUCK
from puckpilot_env.game.step import observe_table
from puckpilot_env.kernel import kernel
from puckpilot_env.physics import compose
from puckpilot_env.physics.gantry.mallet import idle, motion_now, place_axis, place_now
from puckpilot_env.physics.vector import size

BEFORE, ACTION, THEN = 0, 10, 14  # the first column of the inputs of each kind, see `network.INPUTS`
CLEAR = 1e-9  # m between a puck and what it was kept out of
SHORT_OF_MIDDLE = 1e-6  # m
NEAR = 0.05  # m between puck and opponent's mallet, within which one may have struck the other
GAINED = 0.01  # m/s, that only a mallet gives


@kernel
def put_range(states, rows):
    """Set the tables' pucks and mallets by `rows` (n, 12), in the table's frame: the puck's x, y, vx, vy, the mallet of
    player 0 x, y, vx, vy and its acceleration, player 1's x, y, at rest."""
    for i in range(states.size):
        puck, row = states[i].puck, rows[i]
        puck.x, puck.y, puck.vx, puck.vy, puck.spin = row[0], row[1], row[2], row[3], 0.0
        puck.touched[0] = puck.touched[1] = 0
        for k in range(2):
            mallet, at = states[i].mallets[k], 4 if k == 0 else 10
            for a in range(2):
                axis = mallet.x if a == 0 else mallet.y
                v, acceleration = (row[at + 2 + a], row[at + 4 + a]) if k == 0 else (0.0, 0.0)
                place_axis(axis, row[at + a], v, acceleration)
                idle(axis)


@kernel
def _puck_in_frame(puck, p, k, row, at):
    row[at], row[at + 1] = mirror.place(k, puck.x, puck.y, p)
    row[at + 2], row[at + 3] = mirror.velocity(k, puck.vx, puck.vy)


@kernel
def see_before(states, params, inputs, touched):
    """Write what is seen when a step begins; touched (n,): whether the opponent has touched the puck in its half."""
    for i in range(states.size):
        table, p, row = states[i], params[i], inputs[i]
        k = table.puck.turned  # the robot's seat
        _puck_in_frame(table.puck, p, k, row, BEFORE)
        x, y, vx, vy = motion_now(table.mallets[k])
        row[BEFORE + 4], row[BEFORE + 5] = mirror.place(k, x, y, p)
        row[BEFORE + 6], row[BEFORE + 7] = mirror.velocity(k, vx, vy)
        x, y = place_now(table.mallets[1 - k])
        row[BEFORE + 8], row[BEFORE + 9] = mirror.place(k, x, y, p)
        touched[i] = table.puck.touched[1 - k]


@kernel
def see_after(states, params, actions, inputs):
    """Write what is seen of a step when the simulator has played it. actions: float32 (n, 2, 4)."""
    for i in range(states.size):
        table, p, row = states[i], params[i], inputs[i]
        k = table.puck.turned
        row[ACTION], row[ACTION + 1] = actions[i, k, 0], actions[i, k, 1]
        if table.in_pieces == 1 or compose.delay(p) > 0.0:
            row[ACTION + 2], row[ACTION + 3] = abs(table.orders[k, 0, 0]), abs(table.orders[k, 1, 0])
        else:
            row[ACTION + 2], row[ACTION + 3] = abs(table.mallets[k].x.volts), abs(table.mallets[k].y.volts)
        _puck_in_frame(table.puck, p, k, row, THEN)


@kernel
def _is_near(x, y, mallet_x, mallet_y, p):
    return size(x - mallet_x, y - mallet_y) < p.puck_radius + p.mallet_radius + NEAR


@kernel
def _may_be_struck(table, p, row, touched):
    """Whether the opponent's mallet may have struck the puck in the step, as it never did where a network was fitted.

    Its first touch is known. Of another one it was near at one end of the step, or the puck is faster than it was, and
    was beyond the middle line.
    """
    k = table.puck.turned
    if table.puck.touched[1 - k] == 1:
        x, y = mirror.place(k, *place_now(table.mallets[1 - k]), p)
        near = _is_near(row[BEFORE], row[BEFORE + 1], row[BEFORE + 8], row[BEFORE + 9], p)
        if touched == 0 or near or _is_near(row[THEN], row[THEN + 1], x, y, p):
            return True
    beyond = row[BEFORE] >= 0.5 * p.length
    return beyond and size(row[THEN + 2], row[THEN + 3]) > size(row[BEFORE + 2], row[BEFORE + 3]) + GAINED


@kernel
def _goes_on(table, p, row, touched, ended):
    """Whether play simply went on in the step: the episode did not end, the puck was not put anywhere (the clock of its
    half is at 0 then, and else only if it crossed the middle line that moment), is in no goal mouth, and the opponent's
    mallet was not at it."""
    if ended or table.held == 0.0 or _may_be_struck(table, p, row, touched):
        return False
    return p.puck_radius <= table.puck.x <= p.length - p.puck_radius


@kernel
def _kept_in(puck, p, x, y):
    """The place (x, y) [m], or the nearest one on the table, on the side of the middle line where the puck is."""
    middle = 0.5 * p.length
    low, high = p.puck_radius, p.length - p.puck_radius
    if puck.x < middle:
        high = max(middle - SHORT_OF_MIDDLE, puck.x)
    elif puck.x > middle:
        low = min(middle + SHORT_OF_MIDDLE, puck.x)
    else:
        low = high = middle
    return min(max(x, low), high), min(max(y, p.puck_radius), p.width - p.puck_radius)


@kernel
def _move(table, p, dx, dy, dvx, dvy):
    """Correct the puck. Its place stays as it is where the corrected one would be in a mallet and cannot be beside."""
    puck, touch = table.puck, p.puck_radius + p.mallet_radius
    x, y = _kept_in(puck, p, puck.x + dx, puck.y + dy)
    for k in range(2):
        mallet_x, mallet_y = place_now(table.mallets[k])
        distance = size(x - mallet_x, y - mallet_y)
        if 0.0 < distance < touch:
            farther = (touch + CLEAR) / distance
            x, y = _kept_in(puck, p, mallet_x + farther * (x - mallet_x), mallet_y + farther * (y - mallet_y))
    free = True
    for k in range(2):
        mallet_x, mallet_y = place_now(table.mallets[k])
        free = free and size(x - mallet_x, y - mallet_y) >= touch
    if free:
        puck.x, puck.y = x, y
    puck.vx = min(max(puck.vx + dvx, -FASTEST_PUCK), FASTEST_PUCK)
    puck.vy = min(max(puck.vy + dvy, -FASTEST_PUCK), FASTEST_PUCK)


@kernel
def correct_range(
    states, params, nominal, rules, frames, bounds, inputs, touched, terminated, truncated, corrections, went_on,
    observations,
):  # fmt: skip
    """Add `corrections` (n, 4), in the robot's frame, where play simply went on, and observe these tables anew.

    went_on (n,) bool, written: where that is. A correction of 0 changes nothing.
    """
    for i in range(states.size):
        table, p, given = states[i], params[i], corrections[i]
        went_on[i] = _goes_on(table, p, inputs[i], touched[i], terminated[i] or truncated[i])
        if not went_on[i] or (given[0] == 0.0 and given[1] == 0.0 and given[2] == 0.0 and given[3] == 0.0):
            continue
        dx, dy = mirror.velocity(table.puck.turned, given[0], given[1])
        dvx, dvy = mirror.velocity(table.puck.turned, given[2], given[3])
        x, y, vx, vy = table.puck.x, table.puck.y, table.puck.vx, table.puck.vy
        _move(table, p, dx, dy, dvx, dvy)
        puck = table.puck
        sight.correct_puck(table, p, nominal[0], puck.x - x, puck.y - y, puck.vx - vx, puck.vy - vy)
        observe_table(table, p, nominal[0], rules[0], frames[i], bounds, observations[i])
