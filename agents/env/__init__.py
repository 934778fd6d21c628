"""Batches of tables as rsl-rl's vector environment: what the learner observes and what it is rewarded with.

`multi_variant_env` concatenates one `learner_env` for each variant. A `learner_env` steps the tables, lets the
opponents act, and returns the learner's observations, its rewards (`rewards`) and what only the critic sees
(`privileged`). `symmetry` mirrors samples for PPO's data augmentation.
"""
