"""Match: a whole game of air hockey.

Defence and attack follow each other as in the report (section 2.4.3), without resets in between: a player attacks
after a clear, and defends again after its shot, after losing the puck, and after every goal. Scoring is rewarded too.
As in real air hockey a player has seven seconds to send the puck over the middle line; more is a foul, and the opponent
gets the puck.
"""

from puckpilot_env.entry_points import entry_points
from puckpilot_env.game.start import MATCH
from puckpilot_env.variants import FOULS, TOUCHES, Variant

VARIANT = Variant(
    name="match",
    version=0,
    summary="A whole match: first to 7, three minutes, and seven seconds to send the puck over the middle line.",
    game=MATCH,
    ending="First to 7 points, or the leader after 180 s, a draw if level (terminated). After a goal the conceder "
    "serves. A puck that stays 7 s in one half is a foul of the player there, and the opponent serves; where that "
    "player's mallet cannot reach it, or it rests on the middle line, it is faced off instead.",
    history=("v0: first version", FOULS, TOUCHES),
)

env, parallel_env, raw_env = entry_points(VARIANT)
