"""Self-play with an opponent pool: who the learner plays in a round, at which tables, and with what results.

`league` keeps the pool (scripts and snapshots of the learner) and draws a round's opponents from it. `matchmaking`
assigns tables and seats to them in blocks. `block_results` counts points and games in each block, from which the league
updates its members.
"""
