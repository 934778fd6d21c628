"""A training run: what a preset says, the rounds of self-play, PPO, and checkpoints.

`preset` reads how to train, and `settings` what. `run` plays rounds: it sets opponents, lets `runner` (rsl-rl's runner
with `ppo` and `distribution`) collect and learn, and updates the league. `run_state` saves a run after each round and
resumes it, in the file format of `checkpoint` and the folder of `run_folder`. `warm_start` begins a run with another's
networks. `distributed` makes several processes one run.
"""
