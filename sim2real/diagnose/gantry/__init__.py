"""The gantry: what of the mallet's path the commands do not explain."""
