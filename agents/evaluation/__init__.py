"""How good a trained player is.

`matchups` plays it against others, in processes or on a cluster by `fan_out`, and rates all of them. `over_seeds`
summarizes several runs of the same recipe. `deployability` measures whether it could play on a real gantry, whose
accelerations `gantry_load` computes.
"""
