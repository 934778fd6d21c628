"""Games between players, and the tables and pictures of their results.

`match` plays two players against each other in paired games, and `filming` films the first of them. `tournament` plays
every two of several players; `tournament_files` writes the result. Matches are summed up in `payoff` (shown by
`payoff_table`), drills in `role` (shown by `role_table`).
"""
