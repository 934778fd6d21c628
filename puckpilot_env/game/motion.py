"""The motion between two decisions: the puck with what it means, and the mallets on their plans.

Plans that are kept are closed forms for the whole step. Late ones cut it in two, and mallets that their motors do not
carry freely and rigidly go piece by piece.
"""

from __future__ import annotations

from puckpilot_env.game import mirror, rules, sensing
from puckpilot_env.kernel import inlined_kernel, kernel
from puckpilot_env.physics import compose
from puckpilot_env.physics.advance import advance
from puckpilot_env.physics.contacts import bounce
from puckpilot_env.physics.exposures import of_glide
from puckpilot_env.physics.gantry import drive, drivetrain
from puckpilot_env.physics.gantry.mallet import halt, place_at, settle
from puckpilot_env.physics.sliding.drift import drift

MOST_CROSSINGS = (
    200  # of the middle line in one stretch; a puck that jitters there more often is set to rest, and the mallets stall
)
AT_MOST = 1.0 + 1e-6  # times a step: how long late orders are followed
ROUNDING = 1e-9  # s; less is no time to play


@kernel
def play(table, p, rule, now, until, rewards, log, film):
    """The puck's motion from `now` until `until` [s] of the plans with what it means; True if the point is over."""
    for _ in range(MOST_CROSSINGS):
        kind, now, _ = advance(table.puck, p, table.mallets, table.time, now, until, log, film)
        if kind == bounce.NOTHING:
            return False
        if kind == bounce.MIDDLE_LINE:
            entered = 1 if table.puck.vx > 0.0 else 0
            x, y = place_at(table.mallets[entered], now)
            table.held = -now  # the step's period is added at its end
            if table.ending == rules.RUNNING:
                rules.crossed_middle(table, p, rule, rewards, x, y)
        else:
            return True
    table.puck.vx, table.puck.vy = 0.0, 0.0
    of_glide(film, table.puck, 1.0, 0.0, 0.0, now, until, p.friction, p.drag)
    halt(table.mallets[0], now)
    halt(table.mallets[1], now)
    return False


@inlined_kernel
def _play_late(table, p, rule, until, delay, rewards, log, film):
    """`play_step` where the plans of this step begin `delay` [s] late, and the mallets are on those before till then.

    From then on the new plans' time counts.
    """
    first = 0
    while first < film.shape[0] and film[first, 0] <= delay:
        first += 1
    sensing.shoot_mallets(table.mallets, film[:first])
    alone = drift(table.puck, p, table.mallets, table.orders, table.time, delay, until, film)
    over = alone == 0.0 and play(table, p, rule, 0.0, delay, rewards, log, film)
    for i in range(first, film.shape[0]):
        film[i, 0] -= delay
    for k in range(2):
        settle(table.mallets[k], delay)
        drive.follow(table.mallets[k], table.orders[k], mirror.area(k, p), p.max_voltage, AT_MOST * until)
    table.time += delay
    table.held += delay
    if not over:
        over = play(table, p, rule, max(alone - delay, 0.0), until - delay, rewards, log, film[first:])
    sensing.shoot_mallets(table.mallets, film[first:])
    for k in range(2):
        settle(table.mallets[k], until - delay)
        drive.carry_on(table.mallets[k], until - delay)
    table.time -= delay
    table.held -= delay
    return over


@kernel
def _begin_piece(table, p, k, t, least, longest):
    """Begin a piece of the motion of mallet `k` at the time `t` [s]; how long it is [s]."""
    motor, mallet, own, area = table.motors[k], table.mallets[k], table.carriages[k], mirror.area(k, p)
    h = drivetrain.begin_piece(p, k, t, motor, mallet, own, area, min(least, longest), longest)
    drivetrain.drag(p, motor, mallet, own, area, h)
    return h


@kernel
def _play_piece(table, p, rule, now, h, rewards, log, film):
    """`play` a piece of `h` [s] that begins `now` [s] after the decision; `film` has its shots, in its own time."""
    table.time += now
    table.held += now
    over = play(table, p, rule, 0.0, h, rewards, log, film)
    table.time -= now
    table.held -= now
    return over


@kernel
def _shots_until(film, first, now, h):
    """The number of shots up to the end of a piece that begins `now` [s] after the decision; from `first` on they are
    given its own time."""
    last = first
    while last < film.shape[0] and film[last, 0] <= now + h:
        film[last, 0] = min(max(film[last, 0] - now, ROUNDING), h)
        last += 1
    return last


@kernel
def _expect(table, p):
    """Let both mallets expect their orders, see `drivetrain.expect`."""
    one = drivetrain.expect(p, table.mallets[0], table.orders[0])
    return drivetrain.expect(p, table.mallets[1], table.orders[1]) and one


@kernel
def _play_in_pieces(table, p, rule, until, rewards, log, film):
    """`play_step` of mallets that go piece by piece, see `physics.gantry.drivetrain`."""
    begin = min(compose.delay(p), until)  # of the plans that are on their way
    alone, over, waits, shots, pieces = 0.0, False, True, 0, 0
    if begin == 0.0 and _expect(table, p):
        alone = drift(table.puck, p, table.mallets, table.orders, table.time, until, until, film)
    now, left_0, left_1 = 0.0, 0.0, 0.0
    while until - now > ROUNDING:
        if waits and begin - now <= ROUNDING:
            waits, left_0, left_1 = False, 0.0, 0.0
            for k in range(2):
                drivetrain.take(table.motors[k], table.orders[k])
        least = drivetrain.SHORTEST if pieces < drivetrain.MANY_PIECES else until / drivetrain.MANY_PIECES
        longest = (begin if waits else until) - now
        if left_0 <= ROUNDING:
            left_0 = _begin_piece(table, p, 0, table.time + now, least, longest)
        if left_1 <= ROUNDING:
            left_1 = _begin_piece(table, p, 1, table.time + now, least, longest)
        h = min(left_0, left_1)
        last = _shots_until(film, shots, now, h)
        if not over and alone == 0.0:
            over = _play_piece(table, p, rule, now, h, rewards, log, film[shots:last])
        sensing.shoot_mallets(table.mallets, film[shots:last])
        for k in range(2):
            drivetrain.go_on(table.motors[k], table.mallets[k], table.carriages[k], h)
        left_0, left_1, now, shots, pieces = left_0 - h, left_1 - h, now + h, last, pieces + 1
    return over


@kernel
def play_step(table, p, rule, until, rewards, log, film):
    """`play` for a step up to `until` [s], with both mallets' places in the shots of `film`; afterwards the mallets are
    where they are then."""
    if table.in_pieces:
        return _play_in_pieces(table, p, rule, until, rewards, log, film)
    delay = min(compose.delay(p), until)
    if delay > 0.0:
        return _play_late(table, p, rule, until, delay, rewards, log, film)
    over = play(table, p, rule, 0.0, until, rewards, log, film)
    sensing.shoot_mallets(table.mallets, film)
    for k in range(2):
        settle(table.mallets[k], until)
    return over
