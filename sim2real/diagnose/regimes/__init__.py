"""The regimes of the physics, a folder each: sliding, wall, mallet, gantry, sensing; `contact` is what walls
and mallet share.
"""
