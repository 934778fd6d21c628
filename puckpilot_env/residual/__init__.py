"""A black box in place of known physics: a network that corrects the puck at the end of the simulator's steps."""
