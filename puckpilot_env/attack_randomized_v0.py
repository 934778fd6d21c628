"""Attack, randomized: every table differs, and is seen late and noisily through a camera.

What differs is what decides whether a player keeps its skill on a real table: how the puck glides, how walls and
mallets throw it back, how level, flat and large the table is, how its gantries pull and how late they start, and how
late, how regularly and how well its camera sees. Players know the nominal table, and each its own gantry; where the
puck is expected is what the nominal table would do.

The drawn parameters are in `infos` at reset, for those who train a privileged critic or want to know; of them the
agent itself sees its gantry's coefficients alone. Velocities are estimated from camera frames.
"""

from dataclasses import replace

from puckpilot_env import attack_v0
from puckpilot_env.entry_points import entry_points
from puckpilot_env.game.sensing import ESTIMATED
from puckpilot_env.options.randomization import REALITY
from puckpilot_env.variants import NOMINAL

VARIANT = replace(
    attack_v0.VARIANT,
    name="attack-randomized",
    summary="Attack on tables that differ from each other, seen late and noisily through a camera.",
    sensing=ESTIMATED,
    shows_gantry=True,
    draws=REALITY,
    history=(*attack_v0.VARIANT.history, NOMINAL),
)

env, parallel_env, raw_env = entry_points(VARIANT)
