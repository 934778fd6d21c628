"""The regimes of the physics, one folder each: sliding, wall, mallet, gantry, sensing.

`contact` holds what the wall and mallet regimes share.
"""
