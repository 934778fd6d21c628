"""Blows of the robot's mallet: how the puck leaves it, and how it is knocked back."""
