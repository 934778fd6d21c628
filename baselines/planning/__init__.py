"""How the stronger scripted players decide.

`geometry`: where the puck will be and what a mallet can reach. `aim`: shots at the goal, straight or off a wall, and
their chance to score. `attack`: the decision of `interceptor` and `bank_shot`, to strike or to block. `search` and
`rollout`: that of `veteran`, which simulates many candidate actions and plays the one of the highest value.
"""
