"""What is known at a table when an action acts: puck and opponent as they were `observation_age` before, predicted on.

Camera, estimates, and the board's look at a plan take time, over which a loop predicts what it saw: the puck as if
no mallet touched it, a mallet straight on. What happens meanwhile is unseen. A player's own mallet is on its plan and
known, a hand sees the table as it is, and at a face-off nothing has happened yet.
"""

from __future__ import annotations

import numpy as np

from puckpilot_env.game import mirror, predict
from puckpilot_env.kernel import inlined_kernel, kernel
from puckpilot_env.physics.gantry.mallet import motion_now

LOOK = 1e-4  # s over which velocities are measured
SEEN = np.dtype([(name, np.float64) for name in ("x", "y", "vx", "vy")], align=True)  # m, m/s
SIGHT = np.dtype(
    [("puck_age", np.float64), ("puck", SEEN), ("mallets_age", np.float64), ("mallets", SEEN, 2)], align=True
)  # ages of what is seen [s]


@kernel
def look_now(table):
    """See the table as it is."""
    sight = table.sight
    sight.puck_age = sight.mallets_age = 0.0
    sight.puck.x, sight.puck.y = table.puck.x, table.puck.y
    sight.puck.vx, sight.puck.vy = table.puck.vx, table.puck.vy
    for k in range(2):
        seen = sight.mallets[k]
        seen.x, seen.y, seen.vx, seen.vy = motion_now(table.mallets[k])


@kernel
def set_times(p, period, film):
    """The times [s] in a step at which the shots of `film`, two of `sensing.SHOT_COLUMNS`, are taken; the age [s] of
    the later one at its end: the observations', but no more than the step allows."""
    age = min(p.observation_age, period - 2.0 * LOOK)
    film[0, 0], film[1, 0] = period - age - LOOK, period - age
    return age


@kernel
def look_back(table, age, film):
    """See the table as in the shots of `set_times`."""
    table.sight.puck_age = table.sight.mallets_age = age
    _between(table.sight.puck, film, 1)
    for k in range(2):
        _between(table.sight.mallets[k], film, 3 + 2 * k)


@inlined_kernel
def _between(seen, film, column):
    seen.x, seen.y = film[1, column], film[1, column + 1]
    seen.vx, seen.vy = (seen.x - film[0, column]) / LOOK, (seen.y - film[0, column + 1]) / LOOK


@kernel
def expected_puck(table, p, nominal):
    """The puck's place [m] and velocity [m/s] now, as player 0 is shown them."""
    puck = table.sight.puck
    x, y = mirror.shown(0, puck.x, puck.y, p, nominal)
    return predict.expected_place(x, y, puck.vx, puck.vy, nominal, table.sight.puck_age)


@kernel
def correct_puck(table, p, nominal, dx, dy, dvx, dvy):
    """Let the puck be expected so much farther [m] and faster [m/s], in the table's frame."""
    puck = table.sight.puck
    x, y, puck.vx, puck.vy = expected_puck(table, p, nominal)
    puck.x, puck.y = mirror.meant(0, x, y, p, nominal)
    puck.x, puck.y, puck.vx, puck.vy = puck.x + dx, puck.y + dy, puck.vx + dvx, puck.vy + dvy
    table.sight.puck_age = 0.0


@kernel
def expected_mallet(table, p, player):
    """The place [m] and velocity [m/s] of a player's mallet now, in the table's frame."""
    mallet, age = table.sight.mallets[player], table.sight.mallets_age
    x_low, x_high, y_low, y_high = mirror.area(player, p)
    x, y = min(max(mallet.x + age * mallet.vx, x_low), x_high), min(max(mallet.y + age * mallet.vy, y_low), y_high)
    return x, y, mallet.vx, mallet.vy
