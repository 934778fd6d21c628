"""What a table is at an instant, as one numpy record: snapshot, restore and fork are copies of it.

All places are in the table's frame. The puck's `turned` is 1 on a table that was turned round (see `game.mirror`): what
its own random stream draws is then turned too, and so are the effects, so that a turned table plays the same game.
"""

from __future__ import annotations

import numpy as np

from puckpilot_env.game.random_stream import STREAM
from puckpilot_env.game.sight import SIGHT
from puckpilot_env.physics.advance import PUCK
from puckpilot_env.physics.gantry.mallet import MALLET

ERROR_TERMS = 5  # of the camera's smooth error, each component

CAMERA = np.dtype(
    [
        ("error_x", np.float64, ERROR_TERMS),  # coefficients [m, 1, 1, 1/m, 1/m], see `game.sensing.smooth_error`
        ("error_y", np.float64, ERROR_TERMS),
        ("puck_vx", np.float64),  # latest estimate [m/s]
        ("puck_vy", np.float64),
    ],
    align=True,
)
PLACE = np.dtype([("x", np.float64), ("y", np.float64)], align=True)  # m
FRAME = np.dtype(
    [("puck", PLACE), ("seen", np.float64), ("mallets", PLACE, 2)], align=True
)  # as measured; seen: 1 or 0
TABLE = np.dtype(
    [
        ("puck", PUCK),
        ("mallets", MALLET, 2),  # with their gantries and plans
        ("orders", np.float64, (2, 2, 3)),  # that are on their way, of player, axis: signed volts [V], t1, t2 [s]
        ("in_pieces", np.int64),  # 1 if the mallets go piece by piece, see `physics.gantry.drivetrain`
        ("gantry_scale", np.float64, (2, 2, 3)),  # C5, C6, C7 relative to the parameters', of player, axis
        ("frame_phase", np.float64),  # frame j is exposed at (j + frame_phase)/frame_rate
        ("last_frame", np.int64),  # newest frame taken
        ("newest", np.int64),  # newest frame that has arrived by now
        ("camera", CAMERA),
        ("sight", SIGHT),  # where observations are late
        ("time", np.float64),  # since the episode began [s]
        ("held", np.float64),  # since the puck last changed halves [s]
        ("steps", np.int64),  # since the episode began
        ("episode", np.int64),  # how many this table has begun
        ("score", np.int64, 2),
        ("last_score", np.int64, 2),  # of the episode before this one
        ("fouls", np.int64, 2),  # of each player: how often it held the puck for too long
        ("last_fouls", np.int64, 2),  # of the episode before this one
        ("defending", np.int64, 2),  # 1 defence, 0 attack (report, appendix J)
        ("subject", np.int64),  # the player whose episode a drill is
        ("ending", np.int64),  # how the last step ended the episode (see game.rules), 0 if it did not
        ("winner", np.int64),  # of the last episode: 0, 1, or -1 for none
        ("streams", STREAM, 2),  # of each player: what happens to it alone, in its own frame
        ("stream", STREAM),  # of the table
        ("motors", MALLET, 2),  # of mallets that go piece by piece
        ("carriages", np.float64, (2, 2, 3)),  # of player, axis, see `physics.gantry.carriage`
    ],
    align=True,
)
