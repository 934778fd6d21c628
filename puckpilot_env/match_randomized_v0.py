"""Match, randomized: every table differs, and is seen late and noisily through a camera.

The drawn parameters are in `infos` at reset, for those who train a privileged critic or want to know; of them the
agent itself sees its gantry's coefficients alone. Velocities are estimated from camera frames.
"""

from dataclasses import replace

from puckpilot_env import match_v0
from puckpilot_env.entry_points import entry_points
from puckpilot_env.game.sensing import ESTIMATED
from puckpilot_env.randomization import REALITY

VARIANT = replace(
    match_v0.VARIANT,
    name="match-randomized",
    summary="Match on tables that differ from each other, seen late and noisily through a camera.",
    sensing=ESTIMATED,
    shows_gantry=True,
    draws=REALITY,
)

env, parallel_env, raw_env = entry_points(VARIANT)
