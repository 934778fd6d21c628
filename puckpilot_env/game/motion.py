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
from puckpilot_env.physics.hand import is_by_hand
from puckpilot_env.physics.sliding.drift import drift

MOST_CROSSINGS = (
    200  # of the middle line in one stretch; a puck that jitters there more often is set to rest, and the mallets stall
)
AT_MOST = 1.0 + 1e-6  # times a step: how long late orders are followed
ROUNDING = 1e-9  # s; less is no time to play
ALONE, BESET = 0.02, 0.005  # s for which a puck is moved at once past mallets in pieces; till it is tried again


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

    From then on the new plans' time counts. A mallet in a hand is on its new plan all along.
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
        if is_by_hand(table.puck, p, k):
            drive.carry_on(table.mallets[k], delay)
        else:
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
    """Begin a piece of the motion of mallet `k` at the time `t` [s]; how long it is [s]: `longest` in a hand."""
    if is_by_hand(table.puck, p, k):
        return longest
    motor, mallet, carriages, area = table.motors[k], table.mallets[k], table.carriages[k], mirror.area(k, p)
    h = drivetrain.begin_piece(p, k, t, motor, mallet, carriages, area, min(least, longest), longest)
    drivetrain.settle_piece(p, motor, mallet, carriages, area, h)
    return h


@kernel
def _end_piece(table, p, k, h):
    """Let mallet `k` be where it is `h` [s] on in its piece."""
    if is_by_hand(table.puck, p, k):
        settle(table.mallets[k], h)
        drive.carry_on(table.mallets[k], h)
    else:
        drivetrain.go_on(table.motors[k], table.mallets[k], table.carriages[k], mirror.area(k, p), h)


@inlined_kernel
def _play_piece(table, p, rule, now, h, rewards, log, film):
    """`play` a piece of `h` [s] that begins `now` [s] after the decision; `film` has its shots, in its own time."""
    table.time += now
    table.held += now
    over = play(table, p, rule, 0.0, h, rewards, log, film)
    table.time -= now
    table.held -= now
    return over


@inlined_kernel
def _shots_until(film, first, now, h, until):
    """The number of shots up to the end of a piece that begins `now` [s] after the decision, all if that is `until`;
    from `first` on they are given its own time."""
    end = until if until - (now + h) <= ROUNDING else now + h
    last = first
    while last < film.shape[0] and film[last, 0] <= end:
        film[last, 0] = min(max(film[last, 0] - now, ROUNDING), h)
        last += 1
    return last


@kernel
def _rest_in(film, puck):
    """The puck's place in shots of when the point is over."""
    for i in range(film.shape[0]):
        film[i, 1], film[i, 2] = puck.x, puck.y


@kernel
def _take_orders(table):
    for k in range(2):
        drivetrain.take(table.motors[k], table.orders[k])


@kernel
def _drift_on(table, p, now, span, film):
    """Move a puck that meets nothing for `span` [s] whatever the mallets do, from `now` [s] after the decision on, with
    its places in the shots of `film`; till when it was moved."""
    last = 0
    while last < film.shape[0] and film[last, 0] <= now + span:
        film[last, 0] -= now
        last += 1
    moved = drift(table.puck, p, table.mallets, table.orders, table.time + now, span, span, film[:last])
    for i in range(last):
        film[i, 0] += now
    return now + moved


@inlined_kernel
def _play_in_pieces(table, p, rule, until, rewards, log, film):
    """`play_step` of mallets that go piece by piece, see `physics.gantry.drivetrain`."""
    begin = min(compose.delay(p), until)  # of the plans that are on their way
    over, waits, shots, pieces = False, True, 0, 0
    now, rest_0, rest_1 = 0.0, 0.0, 0.0  # rest of each mallet's piece
    alone, asked, span = 0.0, 0.0, until  # till when the puck is moved already; when and how far it may be again
    driven = drivetrain.is_driven_by_orders(p)
    many = drivetrain.FEW_PIECES + drivetrain.PIECES_A_SECOND * until
    while until - now > ROUNDING:
        if waits and begin - now <= ROUNDING:
            waits, rest_0, rest_1 = False, 0.0, 0.0
            _take_orders(table)
        while driven and not (waits or over) and alone <= now and asked <= now:
            alone = _drift_on(table, p, now, min(span, until - now), film[shots:])
            if alone <= now and span <= ALONE:
                asked = now + BESET
            span = ALONE
        least = drivetrain.SHORTEST if pieces < many else drivetrain.LEAST
        longest = (begin if waits else until) - now
        for k in range(2):
            if (rest_0 if k == 0 else rest_1) <= ROUNDING:
                piece = _begin_piece(table, p, k, table.time + now, least, longest)
                rest_0, rest_1 = (piece, rest_1) if k == 0 else (rest_0, piece)
        h = min(rest_0, rest_1)
        if alone > now:
            h = min(h, alone - now)
        last = _shots_until(film, shots, now, h, until)
        if over:
            _rest_in(film[shots:last], table.puck)
        elif alone <= now:
            over = _play_piece(table, p, rule, now, h, rewards, log, film[shots:last])
        sensing.shoot_mallets(table.mallets, film[shots:last])
        for k in range(2):
            _end_piece(table, p, k, h)
        rest_0, rest_1, now, shots, pieces = rest_0 - h, rest_1 - h, now + h, last, pieces + 1
        if alone - now <= ROUNDING:
            alone = 0.0
    if waits:  # they came with the end of the step
        _take_orders(table)
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
