"""Attack: shoot past the other player.

The report's Attack episode (appendix J.2) as a drill of its own. It begins where a successful clear leaves off: the
puck is on player_0's side and moves across the table; player_1 defends.
"""

from puckpilot_env.entry_points import entry_points
from puckpilot_env.game.start import ATTACK
from puckpilot_env.variants import Variant

VARIANT = Variant(
    name="attack",
    version=0,
    summary="The puck is under player_0's control; it has to shoot past player_1.",
    game=ATTACK,
    ending="When the puck crosses the middle line or enters player_0's own goal (terminated), or after 10 s "
    "(truncated).",
    step_limit=100,
)

env, parallel_env, raw_env = entry_points(VARIANT)
