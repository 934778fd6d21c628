"""Players trained by self-play with rsl-rl's PPO. This package stands above `baselines` and alone imports torch.

- `commands`: `puckpilot train`, `evaluate`, `exploit`, `export`, and those of the benchmark.
- `training`: presets, runs and their checkpoints, and PPO.
- `env`: batches of tables as an environment for one learner.
- `league`: the opponent pool, and which opponent plays at which tables.
- `policy`: the trained policy as a file, and as a player that needs no torch.
- `evaluation`: matchups with ratings, comparison of seeds, and deployability on a real gantry.
- `benchmark`: its protocol, the algorithms that learn by it, and entries of the leaderboard.
- `policies` and `presets`: the shipped policy files and the training presets.
"""
