"""Bounces off walls and goal posts: how much of the velocity the puck keeps, and the spin it takes along."""
