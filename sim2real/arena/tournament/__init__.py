"""Several players who meet in turn, while all watch.

- `schedule`: who meets next, by what was played so far.
- `standings`: what came of it, with ratings.
- `tour`: the game of the arena that goes on to the next match by itself.
"""
