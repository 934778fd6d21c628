"""Defence: keep a shot out and take control of the puck.

The report's Defence episode (appendix J.1) as a drill of its own. A shot comes from player_1's half, direct or over a
side wall, at least 0.3 s before it can reach the goal line; player_1 stands behind it and attacks (appendix J.2).
"""

from puckpilot_env.entry_points import entry_points
from puckpilot_env.game.start import DEFENCE
from puckpilot_env.variants import TOUCHES, Variant

VARIANT = Variant(
    name="defence",
    version=0,
    summary="A shot comes from the other half; player_0 has to keep it out and take control.",
    game=DEFENCE,
    ending="When player_0 clears the puck, concedes, or hits it over the middle line (terminated), or after 10 s "
    "(truncated). A shot that leaves its half untouched ends nothing: player_1 has the puck again.",
    step_limit=100,
    history=("v0: first version", TOUCHES),
)

env, parallel_env, raw_env = entry_points(VARIANT)
