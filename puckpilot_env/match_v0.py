"""Match: a whole game of air hockey.

Defence and attack follow each other as in the report (section 2.4.3), without resets in between: a player attacks
after a clear, and defends again after its shot, after losing the puck, and after every goal. Scoring is rewarded too.
"""

from puckpilot_env.entry_points import entry_points
from puckpilot_env.game.start import MATCH
from puckpilot_env.variants import Variant

VARIANT = Variant(
    name="match",
    version=0,
    summary="A whole match: first to 7, three minutes, face-offs, and a rule against holding the puck.",
    game=MATCH,
    ending="First to 7 points, or the leader after 180 s, a draw if level (terminated). After a goal the conceder "
    "serves; a puck that stays 7 s in one half is faced off on the middle line.",
)

env, parallel_env, raw_env = entry_points(VARIANT)
