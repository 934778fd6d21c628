"""Match through sensors alone: a history of delayed position measurements instead of velocities.

The report recommends agents that act on sequences of measurements (section 4). The agent sees the camera frames 0, 1,
2, 5 and 11 frames (of 1/120 s) before the newest one that has arrived, and its own mallet from its encoders.
"""

from dataclasses import replace

from puckpilot_env import match_v0
from puckpilot_env.entry_points import entry_points
from puckpilot_env.game.sensing import HISTORY

VARIANT = replace(
    match_v0.VARIANT,
    name="match-sensors",
    summary="A whole match, seen through delayed position measurements instead of velocities.",
    sensing=HISTORY,
)

env, parallel_env, raw_env = entry_points(VARIANT)
