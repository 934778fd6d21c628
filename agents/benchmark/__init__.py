"""The benchmark: algorithms learn the protocol's tasks, and entries of a leaderboard are held to what they claim.

- `protocol`, with `protocol_v1.toml` and `reference_plays`: what is played, and the hash that freezes it.
- `algorithms`: a file each; `training`: one algorithm learns one task with one seed, and is evaluated; `evaluation`.
- `aggregate`, `report`: tables and figures of what was kept, in the format of marl-eval too.
- `entry`, `sandbox`, `verify`: an entry of `leaderboard/`, played anew in a process with limits of time and memory;
  `leaderboard`: the page over all entries.
"""

from pathlib import Path

LEADERBOARD = Path("leaderboard")  # folder of the entries, in a clone of the project
